#include "tests/support/sewing_model.h"

namespace iso::test {
namespace {

// Distances between what should meet, as multiples of the tolerance.
constexpr std::array<double, 8> kGaps{0, 0, 1e-3, 0.1, 0.24, 0.45, 1.3, 6};

// How far beside a sixteenth of a side it is cut.
constexpr std::array<double, 4> kJitters{0, 0.3, 1.2, 5};

// A side of a patch and how it is divided.
struct Cuts {
  int count = 0;
  double at = 0;  // first place, as a share of the side
  int form = 0;
  bool nothing = false;  // an edge of no length, or next to none, at the first cut
  bool exactly = false;

  explicit Cuts(std::uint8_t bits)
      : count(bits & 3), at(std::max(1, bits >> 2 & 15) / 16.0), form(bits >> 6), nothing((bits & 3) == 3), exactly(bits >> 2 & 1) {
    if (nothing) count = 1;
  }
};

class Maker {
 public:
  explicit Maker(std::uint8_t header) {
    constexpr std::array<double, 4> kTolerances{1e-2, 1e-3, 1e-5, 1e-7}, kUnits{1, 1e3, 1e-3, 1};
    const bool stated = header & 4;
    model.unit = kUnits[header >> 3 & 3];
    model.tolerance = model.unit * (stated ? 1e-5 : kTolerances[header & 3]);
    model.sew = stated ? 0 : model.tolerance;
    model.faces.file_tolerance = stated ? model.tolerance : 0;
    if (header & 32) axes_ = {glm::normalize(Vec3(2, -1, 0.3)), {}, {}};
    if (header & 32) axes_[1] = glm::normalize(glm::cross(Vec3(0.2, 0.5, 1), axes_[0]));
    axes_[2] = glm::cross(axes_[0], axes_[1]);
  }

  void add_patch(std::span<const std::uint8_t> b) {
    jitter_ = kJitters[b[8] & 3];
    place(b);
    const std::size_t faces = model.faces.part.faces.size();
    switch (b[0] & 7) {
      case 0:
      case 1:
      case 2:
        rectangle(Plane{frame_}, {0, 0}, size_, b);
        break;
      case 3:
      case 4:
        rectangle(bulge(b[8]), {0, 0}, {1, 1}, b);
        break;
      case 5:
        rectangle(Cylinder{frame_, size_.x}, {0, 0}, {0.5 * kPi, size_.y}, b);
        break;
      case 6:
        quarter_disc(b);
        break;
      default:
        ring(b);
    }
    Face& face = model.faces.part.faces[faces];
    face.reversed = b[0] & 8;
    face.solid = (b[0] & 0x30) == 0x30 ? 0 : -1;
    if (b[0] & 0x40) share_edges(face);
  }

  SewingModel model;

 private:
  // Where the patch lies: its corner on the lattice, its plane, how large it is and how far beside.
  void place(std::span<const std::uint8_t> b) {
    const Vec3 corner(b[1] & 3, b[1] >> 2 & 3, b[1] >> 4 & 1);
    const std::size_t normal = (b[2] & 3) % 3;
    std::size_t x = (normal + 1) % 3, y = (normal + 2) % 3;
    if (b[1] & 0x20) std::swap(x, y);
    frame_ = {{}, axes_[x], axes_[y], axes_[normal]};
    const double angle = (b[3] >> 3) * kTwoPi / 32;
    const Vec3 beside = std::cos(angle) * axes_[0] + std::sin(angle) * axes_[1] + std::sin(2 * angle) * axes_[2];
    for (int i = 0; i < 3; ++i) frame_.O += corner[i] * model.unit * axes_[static_cast<std::size_t>(i)];
    frame_.O += kGaps[b[3] & 7] * model.tolerance * glm::normalize(beside);
    size_ = model.unit * Vec2(1 + (b[2] >> 2 & 1), 1 + (b[2] >> 3 & 1));
    untrimmed_ = (b[2] & 0x70) == 0x70;
  }

  // Straight borders that the parameters run along unevenly, and a dent in the middle.
  NurbsSurface bulge(std::uint8_t seed) const {
    Random random(seed);
    NurbsSurface s;
    std::vector<double> along[2];
    for (int axis = 0; axis < 2; ++axis) {
      const int degree = whole(random, 1, 3), inner = whole(random, 0, 2);
      (axis ? s.degree_v : s.degree_u) = degree;
      std::vector<double> knots(static_cast<std::size_t>(degree + 1), 0.0);
      for (int i = 0; i < inner; ++i) knots.push_back((i + between(random, 0.2, 0.8)) / inner);
      knots.insert(knots.end(), static_cast<std::size_t>(degree + 1), 1.0);
      const int count = degree + 1 + inner;
      for (int i = 0; i < count; ++i)
        along[axis].push_back(i == 0 ? 0 : i + 1 == count ? 1 : (i + between(random, -0.3, 0.3)) / (count - 1));
      (axis ? s.count_v : s.count_u) = count;
      (axis ? s.knots_v : s.knots_u) = std::move(knots);
    }
    for (int i = 0; i < s.count_u; ++i)
      for (int j = 0; j < s.count_v; ++j) {
        const bool border = i == 0 || j == 0 || i + 1 == s.count_u || j + 1 == s.count_v;
        const Vec2 p = size_ * Vec2(along[0][static_cast<std::size_t>(i)], along[1][static_cast<std::size_t>(j)]);
        const double up = border ? 0 : between(random, -0.3, 0.3) * model.unit;
        s.poles.push_back(homogeneous(frame_.O + p.x * frame_.X + p.y * frame_.Y + up * frame_.Z, 1));
      }
    return s;
  }

  void rectangle(const AnySurface& surface, const UV& lo, const UV& hi, std::span<const std::uint8_t> b) {
    std::vector<TrimLoop> loops;
    const std::array<UV, 4> corner{lo, UV(hi.x, lo.y), hi, UV(lo.x, hi.y)};
    if (!untrimmed_) loops.emplace_back();
    for (std::size_t k = 0; !untrimmed_ && k < 4; ++k) add_side(loops[0], surface, corner[k], corner[(k + 1) % 4], Cuts(b[4 + k]));
    model.faces.add_face(surface, std::move(loops), {lo, hi});
  }

  void quarter_disc(std::span<const std::uint8_t> b) {
    TrimLoop loop;
    const Plane plane{frame_};
    const double r = size_.x;
    add_side(loop, plane, {0, 0}, {r, 0}, Cuts(b[4]));
    add_arc(loop, r, 0, 0.5 * kPi, Cuts(b[5]));
    add_side(loop, plane, {0, r}, {0, 0}, Cuts(b[6]));
    model.faces.add_face(plane, {loop}, {{0, 0}, {r, r}});
  }

  // A disc, the plate around it or the pipe on it.
  void ring(std::span<const std::uint8_t> b) {
    const double r = 0.5 * model.unit, turn = (b[8] >> 4) * kTwoPi / 16;
    const Plane plane{frame_};
    TrimLoop inner;
    switch ((b[8] >> 2 & 3) % 3) {
      case 0:
        return rectangle(Cylinder{frame_, r}, {turn, 0}, {turn + kTwoPi, size_.y}, b);
      case 1:
        add_arc(inner, r, turn, kTwoPi, Cuts(b[4]));
        model.faces.add_face(plane, {inner}, {{-r, -r}, {r, r}});
        return;
      default:
        TrimLoop outer;
        const std::array<UV, 4> corner{size_ * UV(-1, -1), size_ * UV(1, -1), size_, size_ * UV(-1, 1)};
        for (std::size_t k = 0; k < 4; ++k) add_side(outer, plane, corner[k], corner[(k + 1) % 4], Cuts(b[4 + k]));
        add_arc(inner, r, turn, -kTwoPi, Cuts(b[4]));
        model.faces.add_face(plane, {outer, inner}, {-size_, size_});
    }
  }

  // The shares of a side at which it is divided, both ends included.
  std::vector<double> shares(const Cuts& cuts, double length) const {
    std::vector<double> at{0};
    if (cuts.count > 0) at.push_back(std::clamp(cuts.at + jitter_ * model.tolerance / length, 0.03, 0.97));
    if (cuts.nothing) at.push_back(cuts.exactly ? at[1] : std::min(0.98, at[1] + 0.01 * model.tolerance / length));
    if (cuts.count > 1) at.push_back(at[1] + (1 - at[1]) * 0.25);
    at.push_back(1);
    return at;
  }

  // The place at that share of a side's length.
  UV on_side(const AnySurface& surface, const UV& from, const UV& to, double share) const {
    if (!std::holds_alternative<NurbsSurface>(surface) || share == 0 || share == 1) return share == 1 ? to : from + share * (to - from);
    const Point3 a = point(surface, from), b = point(surface, to);
    double lo = 0, hi = 1;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (lo + hi);
      const Point3 p = point(surface, from + middle * (to - from));
      (glm::dot(p - a, b - a) < share * glm::dot(b - a, b - a) ? lo : hi) = middle;
    }
    return from + lo * (to - from);
  }

  void add_side(TrimLoop& loop, const AnySurface& surface, const UV& from, const UV& to, const Cuts& cuts) {
    const std::vector<double> at = shares(cuts, glm::length(point(surface, to) - point(surface, from)) + model.unit);
    for (std::size_t i = 0; i + 1 < at.size(); ++i) {
      const UV a = on_side(surface, from, to, at[i]), b = on_side(surface, from, to, at[i + 1]);
      if (cuts.form < 2 || a == b)
        model.faces.add_line(loop, a, b, cuts.form == 0);
      else
        model.faces.add_edge(loop, uneven_line(a, b, cuts.form == 2 ? 0.3 : 0.6), 0, 1);
    }
  }

  void add_arc(TrimLoop& loop, double r, double start, double sweep, const Cuts& cuts) {
    const std::vector<double> at = shares(cuts, r * std::abs(sweep));
    const double side = cuts.form % 2 ? -1 : 1;  // against the parameter
    for (std::size_t i = 0; i + 1 < at.size(); ++i)
      model.faces.add_edge(loop, Ellipse<Vec2>{UV(0, 0), UV(r, 0), UV(0, side * r)}, side * (start + at[i] * sweep),
                           side * (start + at[i + 1] * sweep));
  }

  // Edges of the face that run with those of faces before become one in the file.
  void share_edges(Face& face) {
    Part& part = model.faces.part;
    for (TrimLoop& loop : face.loops)
      for (TrimCurve& curve : loop.curves)
        for (const Face& other : std::span(part.faces).first(part.faces.size() - 1))
          if (const auto [edge, gap] = same_edge(face, curve, other); edge >= 0) {
            part.edges[static_cast<std::size_t>(curve.edge)].uses = 0;
            Edge& shared = part.edges[static_cast<std::size_t>(edge)];
            ++shared.uses;
            shared.gap = std::max(shared.gap, gap);
            curve.edge = edge;
            ++model.shared;
            break;
          }
  }

  std::pair<int, double> same_edge(const Face& face, const TrimCurve& curve, const Face& of) const {
    const auto at = [](const Face& f, const TrimCurve& c, double s) { return point(f.surface, jet(c.curve, c.t0 + s * (c.t1 - c.t0)).C); };
    for (const TrimLoop& loop : of.loops)
      for (const TrimCurve& other : loop.curves)
        for (const bool reversed : {false, true}) {
          double apart = 0;
          for (const double s : {0.0, 0.25, 0.5, 1.0})
            apart = std::max(apart, glm::length(at(face, curve, s) - at(of, other, reversed ? 1 - s : s)));
          if (apart <= model.tolerance && glm::length(at(face, curve, 0) - at(face, curve, 0.5)) > 4 * model.tolerance)
            return {other.edge, apart};
        }
    return {-1, 0};
  }

  std::array<Vec3, 3> axes_{Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
  Frame frame_;
  Vec2 size_{0.0};
  bool untrimmed_ = false;
  double jitter_ = 0;
};

}  // namespace

SewingModel sewing_model(std::span<const std::uint8_t> bytes) {
  Maker maker(bytes.empty() ? std::uint8_t{0} : bytes[0]);
  if (bytes.empty()) return std::move(maker.model);
  const auto patches = bytes.subspan(kSewingHeader);
  for (std::size_t i = 0; i < std::min(kMostPatches, patches.size() / kPatchBytes); ++i)
    maker.add_patch(patches.subspan(i * kPatchBytes, kPatchBytes));
  return std::move(maker.model);
}

std::vector<std::uint8_t> random_sewing_bytes(std::uint64_t seed) {
  Random random(seed);
  std::vector<std::uint8_t> bytes(kSewingHeader + kPatchBytes * static_cast<std::size_t>(whole(random, 2, kMostPatches)));
  for (std::uint8_t& b : bytes) b = static_cast<std::uint8_t>(random());
  // Few faces are of a solid or share edges, a quarter of the models left out; half of the models have gaps that all may be closed.
  for (std::size_t i = kSewingHeader; i < bytes.size(); i += kPatchBytes) {
    if (whole(random, 0, 3)) bytes[i] = static_cast<std::uint8_t>(bytes[i] & ~0x70u);
    if (seed % 4 == 1) bytes[i] |= 0x40;
    bytes[i + 1] = static_cast<std::uint8_t>(bytes[i + 1] & ~0xau);
    if (seed % 2) bytes[i + 3] = static_cast<std::uint8_t>(bytes[i + 3] % 5 + (bytes[i + 3] & ~7u));
    // Half of the sides are not cut.
    for (std::size_t side = 4; side < 8; ++side)
      if (whole(random, 0, 1)) bytes[i + side] = static_cast<std::uint8_t>(bytes[i + side] & ~3u);
    // Some patches are copies.
    if (i > kSewingHeader && whole(random, 0, 9) == 0) std::copy_n(&bytes[i - kPatchBytes], 3, &bytes[i]);
  }
  return bytes;
}

}  // namespace iso::test
