#include "tess/edge_match.h"

namespace iso {

namespace {

// Curves of which one is longer than the other by more than this share do not run together.
constexpr double kLengthDiffers = 0.1;

// Places that belong together lie at shares of the length that differ by no more than this.
constexpr double kWindow = 0.15;

// Edges shorter than this many tolerances are no edges at that tolerance.
constexpr double kTooShort = 4;

// Equal shares do if their distance is below this many times that of the nearest places, or this share of the length.
constexpr double kEvenFactor = 2, kEvenShare = 1e-9;

Point3 place(const EdgePiece& piece, const EdgeUse& use, double share) { return point(piece.face->surface, uv_at(use, share)); }

double even_share(std::size_t i, std::size_t parts) { return static_cast<double>(i) / static_cast<double>(parts); }

// How many different knots lie inside an interval.
int knots_inside(const std::vector<double>& knots, double a, double b) {
  int count = 0;
  for (std::size_t i = 0; i < knots.size(); ++i)
    count += knots[i] > std::min(a, b) && knots[i] < std::max(a, b) && (i == 0 || knots[i] != knots[i - 1]);
  return count;
}

// The curve of a use bends anew at the knots that it crosses.
std::size_t parts_of(const Face& face, const EdgeUse& use) {
  int spans = 1;
  if (const auto* curve = std::get_if<NurbsCurve<Vec2>>(&use.curve.curve)) spans += knots_inside(curve->knots, use.curve.t0, use.curve.t1);
  if (const auto* nurbs = std::get_if<NurbsSurface>(&face.surface)) {
    Box2 box;
    for (int i = 0; i <= kTraced; ++i) box.include(uv_at(use, even_share(static_cast<std::size_t>(i), kTraced)));
    spans += knots_inside(nurbs->knots_u, box.lo.x, box.hi.x) + knots_inside(nurbs->knots_v, box.lo.y, box.hi.y);
  }
  return static_cast<std::size_t>(std::clamp(kTracedOfSpan * spans, kTraced, kMostTraced));
}

// Two borders of one face that enclose nothing but a sliver are no seam: between them the surface stays near them.
bool encloses_sliver(const EdgePiece& first, const EdgeUse& directed, double tolerance) {
  const UV a = uv_at(first.use, 0.5), b = uv_at(directed, 0.5);
  return glm::length(point(first.face->surface, 0.5 * (a + b)) - place(first, first.use, 0.5)) <= 2 * tolerance;
}

// Whether they are one curve in (u, v): a slit, or a loop that runs back over itself.
bool is_slit(const EdgePiece& first, const EdgeUse& directed, const EdgeMatch& match) {
  const Vec2 same = kEvenShare * first.face->domain.size();
  const std::size_t parts = match.shares.size() - 1;
  for (std::size_t k = 0; k <= parts; ++k)
    if (const Vec2 d = glm::abs(uv_at(first.use, even_share(k, parts)) - uv_at(directed, match.shares[k])); d.x > same.x || d.y > same.y)
      return false;
  return true;
}

// The polyline of a piece run through in either direction.
EdgePiece directed(const EdgePiece& piece, bool reversed) {
  EdgePiece result = piece;
  if (!reversed) return result;
  result.use.forward = !piece.use.forward;
  std::reverse(result.at.begin(), result.at.end());
  for (std::size_t i = 0; i < piece.along.size(); ++i) result.along[i] = piece.length() - piece.along[piece.along.size() - 1 - i];
  return result;
}

// Shares below 0 are not known: they go evenly from the known one before to the one after.
void fill_evenly(std::vector<double>& shares) {
  std::size_t known = 0;
  for (std::size_t k = 1; k < shares.size(); ++k) {
    if (shares[k] < 0) continue;
    for (std::size_t i = known + 1; i < k; ++i)
      shares[i] = shares[known] + (shares[k] - shares[known]) * static_cast<double>(i - known) / static_cast<double>(k - known);
    known = k;
  }
}

// The nearest places, where they follow one another; near ends that are not in the same place they do not, and go evenly.
std::optional<EdgeMatch> match_nearest(const EdgePiece& first, const EdgePiece& second, const MatchPolicy& policy) {
  EdgeMatch result;
  const std::size_t parts = first.at.size() - 1;
  result.shares.assign(parts + 1, -1);
  result.shares.front() = 0;
  result.shares.back() = 1;
  double last = 0;
  for (std::size_t k = 1; k < parts; ++k) {
    const double expected = first.along[k] / first.length();
    const NearPlace near =
        nearest_place(second, first.at[k], 2 * std::max(policy.ends, policy.between), expected - kWindow, expected + kWindow);
    const bool at_end = near.share <= 0 || near.share >= 1;
    if (!(near.distance <= (at_end ? 2 * policy.ends : policy.between))) return std::nullopt;
    if (!at_end && near.share > last) last = result.shares[k] = near.share;
  }
  const std::vector<double> found = result.shares;
  fill_evenly(result.shares);
  double evenly = 0;
  for (std::size_t k = 0; k <= parts; ++k) {
    const double distance = glm::length(first.at[k] - place(second, second.use, result.shares[k]));
    if (found[k] < 0 && distance > 2 * policy.ends) return std::nullopt;
    result.apart = std::max(result.apart, distance);
    evenly = std::max(evenly, glm::length(first.at[k] - place(second, second.use, even_share(k, parts))));
  }
  result.even = evenly <= std::max(kEvenFactor * result.apart, kEvenShare * first.length());
  return result;
}

}  // namespace

EdgePiece trace(const Part& part, const std::vector<EdgeUse>& uses, int use, double a, double b) {
  EdgePiece piece;
  piece.origin = use;
  piece.a = a;
  piece.b = b;
  piece.use = part_of(uses[static_cast<std::size_t>(use)], a, b);
  piece.face = &part.faces[static_cast<std::size_t>(piece.use.face)];
  piece.along.push_back(0);
  const std::size_t parts = parts_of(*piece.face, piece.use);
  for (std::size_t i = 0; i <= parts; ++i) {
    piece.at.push_back(place(piece, piece.use, even_share(i, parts)));
    piece.box.include(piece.at.back());
    const std::size_t n = piece.at.size();
    if (n >= 2) piece.along.push_back(piece.along.back() + glm::length(piece.at[n - 1] - piece.at[n - 2]));
    if (n >= 3) piece.sag = std::max(piece.sag, 0.5 * glm::length(piece.at[n - 1] - 2.0 * piece.at[n - 2] + piece.at[n - 3]));
  }
  piece.box = piece.box.inflated(piece.sag);
  return piece;
}

NearPlace nearest_place(const EdgePiece& piece, const Point3& p, double within, double from_length, double to_length) {
  const double step_share = 1.0 / static_cast<double>(piece.at.size() - 1);
  double best = kInf, share = 0;
  for (std::size_t i = 0; i + 1 < piece.at.size(); ++i) {
    if (piece.along[i + 1] < from_length * piece.length() || piece.along[i] > to_length * piece.length()) continue;
    const Vec3 step = piece.at[i + 1] - piece.at[i];
    const double length2 = glm::dot(step, step);
    const double s = length2 > 0 ? std::clamp(glm::dot(p - piece.at[i], step) / length2, 0.0, 1.0) : 0.0;
    const double distance = glm::length(p - piece.at[i] - s * step);
    if (distance >= best) continue;
    best = distance;
    share = (static_cast<double>(i) + s) * step_share;
  }
  if (best > within + piece.sag) return {};
  NearPlace result;
  result.share = slide_share(*piece.face, piece.use, p, share, std::max(0.0, share - step_share), std::min(1.0, share + step_share));
  result.distance = glm::length(p - place(piece, piece.use, result.share));
  return result;
}

std::optional<EdgeMatch> match(const EdgePiece& first, const EdgePiece& second, const MatchPolicy& policy) {
  if (std::abs(first.length() - second.length()) > kLengthDiffers * std::max(first.length(), second.length()) + 4 * policy.ends)
    return std::nullopt;
  if (first.length() < kTooShort * policy.ends) return std::nullopt;
  std::optional<EdgeMatch> best;
  for (const bool reversed : {false, true}) {
    const Point3 &from = reversed ? second.at.back() : second.at.front(), &to = reversed ? second.at.front() : second.at.back();
    if (glm::length(first.at.front() - from) > 2 * policy.ends || glm::length(first.at.back() - to) > 2 * policy.ends) continue;
    const EdgePiece other = directed(second, reversed);
    auto found = match_nearest(first, other, policy);
    if (found && first.face == second.face && encloses_sliver(first, other.use, policy.between) && !is_slit(first, other.use, *found))
      continue;
    if (!found || (best && best->apart <= found->apart)) continue;
    found->reversed = reversed;
    best = std::move(found);
  }
  return best;
}

}  // namespace iso
