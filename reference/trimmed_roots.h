// All meetings of a line with the trimmed faces of a part, slow and independent of the tracer: roots by first_root.h, and for each the side
// of the trim loops it lies on. The loops are drawn as polygons that get finer towards the root, down to rounding, and
// winding.h counts. Shares with the tracer the Bezier pieces and the curves, nothing of its solvers or trim regions.
#pragma once

#include <algorithm>

#include "patches/brep.h"
#include "reference/first_root.h"
#include "reference/winding.h"

namespace iso::reference {

// `border`: on a trim curve, to rounding, or outside but within the gap that is to be closed there: both answers are right.
enum class Side : std::uint8_t { inside, border, outside };

struct Meeting {
  double t = kInf;
  int face = -1;
  UV uv{0.0};
  Side side = Side::outside;
  bool doubtful = false;  // the line touches the surface, or nearly
  double cosine = 0;      // between line and normal; 0 where doubtful
};

// The surface near a point as a plane: distances are those of space there.
struct TangentPlane {
  UV uv;
  double uu = 0, uv_along = 0, vv = 0;

  TangentPlane(const AnySurface& surface, UV at) : uv(at) {
    const Jet2 j = jet2(surface, at);
    uu = glm::length(j.Su);
    if (!(uu > 0)) return;
    uv_along = glm::dot(j.Su, j.Sv) / uu;
    vv = glm::length(glm::cross(j.Su, j.Sv)) / uu;
  }
  bool singular() const { return !(uu > 0 && vv > 0); }
  Vec2 operator()(UV p) const { return {uu * (p.x - uv.x) + uv_along * (p.y - uv.y), vv * (p.y - uv.y)}; }
};

// Draws a trim curve around the origin of a tangent plane: a chord is halved as long as the origin is nearer than it is long.
class Drawing {
 public:
  Drawing(const TrimCurve& curve, const TangentPlane& plane) : curve_(curve), plane_(plane) {}

  // Adds all corners but the last one to `polygon`; returns the distance of the origin.
  double draw(Polygon& polygon) {
    const bool straight = std::holds_alternative<Line<Vec2>>(curve_.curve);
    add(0, 1, at(0), at(1), straight ? kDeepest : 0, polygon);
    return nearest_;
  }

 private:
  static constexpr int kCoarse = 7;  // halvings of every curve: a chord then bends by far less than its length
  static constexpr int kDeepest = 50;

  Vec2 at(double share) const { return plane_(jet(curve_.curve, curve_.t0 + share * (curve_.t1 - curve_.t0)).C); }

  void add(double from, double to, const Vec2& a, const Vec2& b, int depth, Polygon& polygon) {
    const Vec2 chord = b - a;
    const double length2 = glm::dot(chord, chord);
    const double s = length2 > 0 ? std::clamp(-glm::dot(a, chord) / length2, 0.0, 1.0) : 0.0;
    const double distance = glm::length(a + s * chord);
    if (depth >= kDeepest || (depth >= kCoarse && distance > std::sqrt(length2))) {
      nearest_ = std::min(nearest_, distance);
      polygon.push_back(a);
      return;
    }
    const double middle = 0.5 * (from + to);
    const Vec2 m = at(middle);
    add(from, middle, a, m, depth + 1, polygon);
    add(middle, to, m, b, depth + 1, polygon);
  }

  const TrimCurve& curve_;
  const TangentPlane& plane_;
  double nearest_ = kInf;
};

// `cosine`: between line and normal; gaps are wider for a line that grazes, up to kMostStretch times. `rounding`: world units. A singular
// point of the surface is a border.
inline Side side_of(const Face& face, const std::vector<Edge>& edges, UV uv, double cosine, double rounding) {
  constexpr double kMostStretch = 8;  // as much as the tracer grants
  if (face.loops.empty()) return Side::inside;
  const TangentPlane plane(face.surface, uv);
  if (plane.singular()) return Side::border;
  const double stretch = std::min(kMostStretch, 1 / std::abs(cosine));
  std::vector<Polygon> polygons;
  bool within_gap = false;
  for (const TrimLoop& loop : face.loops) {
    Polygon polygon;
    for (const TrimCurve& curve : loop.curves) {
      const double distance = Drawing(curve, plane).draw(polygon);
      if (distance <= rounding) return Side::border;
      within_gap = within_gap || (curve.edge >= 0 && distance <= stretch * edges[static_cast<std::size_t>(curve.edge)].closing + rounding);
    }
    polygons.push_back(std::move(polygon));
  }
  if (inside_even_odd(polygons, Vec2(0.0))) return Side::inside;
  return within_gap ? Side::border : Side::outside;
}

class TrimmedRoots {
 public:
  // The part must outlive this.
  explicit TrimmedRoots(const Part& part) : part_(part), roots_(patches_of(part)), size_(part.box.diagonal()) {}

  // Sorted by t >= 0; d is a unit vector. Meetings outside of their face's loops are among them.
  std::vector<Meeting> all(const Vec3& o, const Vec3& d) const {
    std::vector<Meeting> found;
    roots_.each(o, d, [&](const LineRoot& root) {
      const BezierPiece& piece = pieces_[root.patch];
      found.push_back({root.t, faces_[root.patch], piece.to_native(root.st), Side::outside, root.doubtful, root.cosine});
    });
    std::sort(found.begin(), found.end(),
              [](const Meeting& a, const Meeting& b) { return a.face != b.face ? a.face < b.face : a.t < b.t; });
    // Of a root that is found twice, at both ends of a closed surface, the one within the loops counts.
    std::vector<Meeting> out;
    for (Meeting& m : found) {
      m.side = side_of(part_.faces[static_cast<std::size_t>(m.face)], part_.edges, m.uv, m.cosine, kRounding * size_);
      if (out.empty() || !again(out.back(), m))
        out.push_back(m);
      else if (m.side < out.back().side)
        out.back() = m;
    }
    std::sort(out.begin(), out.end(), [](const Meeting& a, const Meeting& b) { return a.t < b.t; });
    return out;
  }

 private:
  static constexpr double kRounding = 1e-11;  // sizes
  static constexpr double kBeyond = 1e-2;     // of the domain: surfaces go on beyond it, for the gaps of edges that lie on its border

  std::vector<BezierPatch> patches_of(const Part& part) {
    std::vector<BezierPatch> patches;
    for (std::size_t f = 0; f < part.faces.size(); ++f) {
      const Face& face = part.faces[f];
      const Vec2 more = face.loops.empty() ? Vec2(0.0) : kBeyond * face.domain.size();
      for (BezierPiece& piece : bezier_pieces(face.surface, {face.domain.lo - more, face.domain.hi + more})) {
        patches.push_back(piece.patch);
        faces_.push_back(static_cast<int>(f));
        pieces_.push_back(std::move(piece));
      }
    }
    return patches;
  }

  // One root found twice, or boxes of one touch.
  bool again(const Meeting& a, const Meeting& b) const {
    return a.face == b.face && a.doubtful == b.doubtful && b.t - a.t <= kRounding * size_;
  }

  const Part& part_;
  std::vector<int> faces_;  // of the patches
  std::vector<BezierPiece> pieces_;
  RootFinder roots_;
  double size_;
};

}  // namespace iso::reference
