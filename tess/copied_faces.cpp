#include "tess/copied_faces.h"

#include <algorithm>

#include "patches/trim.h"
#include "tess/box_tree.h"
#include "tess/edge_match.h"
#include "tess/join_edges.h"

namespace iso {
namespace {

// Places of each border curve that are compared, and of each side of the domain's grid.
constexpr std::size_t kOnCurve = 8;
constexpr int kGrid = 6;

// Boxes of places on one border, parametrised in two ways, differ by less than this share of their diagonal.
constexpr double kLike = 0.01;

// Normals that agree this well, as a cosine, look to the same side; copies agree to rounding, and other faces at such places rarely.
constexpr double kSameSide = 0.999;

std::vector<TrimCurve> border_of(const Face& face) {
  std::vector<TrimCurve> curves;
  for (const TrimLoop& loop : face.loops) curves.insert(curves.end(), loop.curves.begin(), loop.curves.end());
  if (!face.loops.empty()) return curves;
  const Box2& d = face.domain;
  const std::array<UV, 4> corner{d.lo, UV(d.hi.x, d.lo.y), d.hi, UV(d.lo.x, d.hi.y)};
  for (std::size_t k = 0; k < 4; ++k) curves.push_back({Line<Vec2>{corner[k], corner[(k + 1) % 4] - corner[k]}, 0, 1, -1});
  return curves;
}

Box3 border_box(const Face& face) {
  Box3 box;
  for (const TrimCurve& c : border_of(face))
    for (std::size_t i = 0; i <= kTraced; ++i)
      box.include(point(face.surface, jet(c.curve, c.t0 + (c.t1 - c.t0) * static_cast<double>(i) / kTraced).C));
  return box;
}

// A face made ready to be compared.
class Comparable {
 public:
  Comparable(const Part& part, int face) : face_(&part.faces[static_cast<std::size_t>(face)]), region_(*face_, part.edges, 0) {
    std::vector<EdgeUse> uses;
    for (const TrimCurve& c : border_of(*face_)) uses.push_back({face, -1, c, true, true});
    for (std::size_t u = 0; u < uses.size(); ++u) border_.push_back(trace(part, uses, static_cast<int>(u), 0, 1));
    for (int i = 0; i < kGrid; ++i)
      for (int j = 0; j < kGrid; ++j) {
        const UV uv = face_->domain.lo + face_->domain.size() * Vec2(i + 0.5, j + 0.5) / static_cast<double>(kGrid);
        if (region_.contains(uv, face_->surface).inside) inside_.push_back(uv);
      }
  }

  // Whether all that is looked at of this face lies on the other.
  bool lies_on(const Comparable& other, double within) const {
    for (const EdgePiece& piece : border_)
      for (std::size_t k = 0; k < piece.at.size(); k += (piece.at.size() - 1) / kOnCurve)
        if (!other.has_on_border(piece.at[k], within)) return false;
    for (const UV& uv : inside_)
      if (!other.has_inside(point(face_->surface, uv), normal(uv), within)) return false;
    return !inside_.empty();
  }

 private:
  Vec3 normal(const UV& uv) const {
    const Vec3 n = unit_normal(face_->surface, uv, face_->domain);
    return face_->reversed ? -n : n;
  }

  bool has_on_border(const Point3& p, double within) const {
    return std::any_of(border_.begin(), border_.end(), [&](const EdgePiece& piece) {
      return piece.box.inflated(within).contains(p) && nearest_place(piece, p, within).distance <= within;
    });
  }

  bool has_inside(const Point3& p, const Vec3& n, double within) const {
    return std::any_of(inside_.begin(), inside_.end(), [&](const UV& from) {
      const UV uv = foot(p, from);
      return glm::length(point(face_->surface, uv) - p) <= within && glm::dot(normal(uv), n) >= kSameSide &&
             region_.contains(uv, face_->surface).inside;
    });
  }

  // The surface's place nearest to p, by Gauss-Newton steps from a place near it.
  UV foot(const Point3& p, UV uv) const {
    constexpr int kSteps = 20;
    for (int i = 0; i < kSteps; ++i) {
      const Jet2 at = jet2(face_->surface, uv);
      const Vec3 r = p - at.S;
      const double a = glm::dot(at.Su, at.Su), b = glm::dot(at.Su, at.Sv), c = glm::dot(at.Sv, at.Sv), det = a * c - b * b;
      if (!(det > 0)) break;
      const double x = glm::dot(r, at.Su), y = glm::dot(r, at.Sv);
      const UV next = glm::clamp(uv + UV(c * x - b * y, a * y - b * x) / det, face_->domain.lo, face_->domain.hi);
      if (next == uv) break;
      uv = next;
    }
    return uv;
  }

  const Face* face_;
  TrimRegion region_;
  std::vector<EdgePiece> border_;
  std::vector<UV> inside_;
};

}  // namespace

std::vector<int> copied_faces(const Part& part) {
  const double within = kSameBorder * part.box.diagonal();
  std::vector<int> copy_of(part.faces.size(), -1);
  // Copies have about the same middle of the border, and the same extent of it.
  std::vector<Vec3> sizes;
  std::vector<Box3> middles;
  for (const Face& face : part.faces) {
    const Box3 box = border_box(face);
    sizes.push_back(box.size());
    middles.push_back(Box3{box.middle(), box.middle()}.inflated(within + kLike * box.diagonal()));
  }
  const BoxTree<Vec3> tree(middles);
  for (std::size_t f = 0; f < part.faces.size(); ++f) {
    std::vector<std::uint32_t> like;
    tree.for_each_touching(middles[f], [&](std::uint32_t g) {
      const Vec3 d = glm::abs(sizes[f] - sizes[g]);
      const double most = within + kLike * glm::length(sizes[f]);
      if (g < f && copy_of[g] < 0 && part.faces[f].solid == part.faces[g].solid && d.x <= most && d.y <= most && d.z <= most)
        like.push_back(g);
    });
    if (like.empty()) continue;
    std::sort(like.begin(), like.end());
    const Comparable own(part, static_cast<int>(f));
    for (const std::uint32_t g : like) {
      const Comparable other(part, static_cast<int>(g));
      if (!own.lies_on(other, within) || !other.lies_on(own, within)) continue;
      copy_of[f] = static_cast<int>(g);
      break;
    }
  }
  return copy_of;
}

}  // namespace iso
