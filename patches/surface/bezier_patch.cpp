#include "patches/surface/bezier_patch.h"

#include <array>

#include "patches/base/bernstein.h"
#include "patches/base/four.h"
#include "patches/curve/bspline_tools.h"

namespace iso {

HomogeneousJet homogeneous_jet(const BezierPatch& patch, const Vec2& st) {
  BernsteinBasis bs, bt;
  bernstein_basis(patch.pu, st.x, bs);
  bernstein_basis(patch.pv, st.y, bt);
  Four H{}, Hs{}, Ht{};
  const Vec4* row = patch.net.data();
  for (int i = 0; i <= patch.pu; ++i, row += patch.pv + 1) {
    Four value{}, slope{};
    for (int j = 0; j <= patch.pv; ++j) {
      const Four h(row[j]);
      value += bt.B[j] * h;
      slope += bt.D[j] * h;
    }
    H += bs.B[i] * value;
    Hs += bs.D[i] * value;
    Ht += bs.B[i] * slope;
  }
  return {Vec4(H), Vec4(Hs), Vec4(Ht)};
}

BezierPatch part_of(const BezierPatch& patch, const Vec2& lo, const Vec2& hi) {
  BezierPatch out = patch;
  const std::size_t columns = static_cast<std::size_t>(patch.pv) + 1;
  for (int j = 0; j <= patch.pv; ++j) bernstein_restrict(&out.net[static_cast<std::size_t>(j)], columns, patch.pu, lo.x, hi.x);
  for (int i = 0; i <= patch.pu; ++i) bernstein_restrict(&out.net[static_cast<std::size_t>(i) * columns], 1, patch.pv, lo.y, hi.y);
  return out;
}

void split_in_half(const BezierPatch& patch, int direction, BezierPatch& low, BezierPatch& high) {
  low.pu = high.pu = patch.pu;
  low.pv = high.pv = patch.pv;
  low.net.resize(patch.net.size());
  high.net.resize(patch.net.size());
  const int lines = direction == 0 ? patch.pv : patch.pu, degree = direction == 0 ? patch.pu : patch.pv;
  const std::size_t step = direction == 0 ? static_cast<std::size_t>(patch.pv) + 1 : 1,
                    across = direction == 0 ? 1 : static_cast<std::size_t>(patch.pv) + 1;
  std::array<Four, kMaxDegree + 1> work;
  for (int k = 0; k <= lines; ++k) {
    const std::size_t base = static_cast<std::size_t>(k) * across;
    for (int i = 0; i <= degree; ++i) work[i] = Four(patch.net[base + i * step]);
    for (int level = 0; level <= degree; ++level) {
      work[0].store(low.net[base + level * step]);
      work[degree - level].store(high.net[base + (degree - level) * step]);
      for (int i = 0; i + level < degree; ++i) work[i] = 0.5 * (work[i] + work[i + 1]);
    }
  }
}

Box3 hull_box(const BezierPatch& patch) {
  Box3 box;
  for (const Vec4& h : patch.net) box.include(project(h));
  return box;
}

// ---- native surfaces as pieces -----------------------------------------------------------------------------------------

namespace {

struct AngleArc {
  double a, b;
};

std::vector<AngleArc> quarter_turns(double a, double b) {
  const int n = std::max(1, static_cast<int>(std::ceil((b - a) / (kPi / 2) - 1e-9)));
  std::vector<AngleArc> arcs;
  for (int i = 0; i < n; ++i) arcs.push_back({i == 0 ? a : a + (b - a) * i / n, i + 1 == n ? b : a + (b - a) * (i + 1) / n});
  return arcs;
}

// Axis and the sense in which rising angles turn about it (-1 for the angle of a left-handed frame).
struct Turn {
  Vec3 O, Z;
  double sense = 1;

  Vec3 radial(const Vec3& p) const { return p - O - glm::dot(p - O, Z) * Z; }
  Vec3 turned(const Vec3& r, double angle) const { return std::cos(angle) * r + sense * std::sin(angle) * glm::cross(Z, r); }
};

// A span of a profile curve turned through one arc: a rational quadratic in u whose middle row lies where the end tangents meet.
BezierPiece turned_piece(const Turn& turn, const BezierSpan<Vec3>& span, const AngleArc& arc) {
  BezierPiece piece;
  piece.u = {ParamMap::Kind::arc, arc.a, arc.b};
  piece.v = span.map;
  piece.patch.pu = 2;
  piece.patch.pv = static_cast<int>(span.points.size()) - 1;
  piece.patch.net.resize(3 * span.points.size());
  const double c = std::cos(0.5 * (arc.b - arc.a));
  for (int j = 0; j <= piece.patch.pv; ++j) {
    const Vec4 h = span.points[j];
    const Vec3 p = project(h), r = turn.radial(p), axis = p - r;
    piece.patch.at(0, j) = homogeneous(axis + turn.turned(r, arc.a), h.w);
    piece.patch.at(1, j) = homogeneous(axis + turn.turned(r, 0.5 * (arc.a + arc.b)) / c, h.w * c);
    piece.patch.at(2, j) = homogeneous(axis + turn.turned(r, arc.b), h.w);
  }
  return piece;
}

std::vector<BezierPiece> turned_pieces(const Turn& turn, const Curve3& profile, const Box2& uv) {
  std::vector<BezierPiece> pieces;
  for (const auto& span : bezier_spans(profile, uv.lo.y, uv.hi.y))
    for (const AngleArc& arc : quarter_turns(uv.lo.x, uv.hi.x)) pieces.push_back(turned_piece(turn, span, arc));
  return pieces;
}

Turn turn_of(const Frame& f) { return {f.O, f.Z, glm::dot(glm::cross(f.X, f.Y), f.Z) < 0 ? -1.0 : 1.0}; }

std::vector<BezierPiece> pieces_of(const Plane& s, const Box2& uv) {
  BezierPiece piece;
  piece.u = {ParamMap::Kind::affine, uv.lo.x, uv.hi.x};
  piece.v = {ParamMap::Kind::affine, uv.lo.y, uv.hi.y};
  piece.patch.pu = piece.patch.pv = 1;
  for (const double u : {uv.lo.x, uv.hi.x})
    for (const double v : {uv.lo.y, uv.hi.y}) piece.patch.net.push_back(homogeneous(s.frame.O + u * s.frame.X + v * s.frame.Y, 1.0));
  return {piece};
}
std::vector<BezierPiece> pieces_of(const Cylinder& s, const Box2& uv) {
  return turned_pieces(turn_of(s.frame), Line<Vec3>{s.frame.O + s.r * s.frame.X, s.frame.Z}, uv);
}
std::vector<BezierPiece> pieces_of(const Cone& s, const Box2& uv) {
  const Vec3 slope = std::sin(s.half_angle) * s.frame.X + std::cos(s.half_angle) * s.frame.Z;
  return turned_pieces(turn_of(s.frame), Line<Vec3>{s.frame.O + s.r * s.frame.X, slope}, uv);
}
std::vector<BezierPiece> pieces_of(const Sphere& s, const Box2& uv) {
  return turned_pieces(turn_of(s.frame), Ellipse<Vec3>{s.frame.O, s.r * s.frame.X, s.r * s.frame.Z}, uv);
}
std::vector<BezierPiece> pieces_of(const Torus& s, const Box2& uv) {
  return turned_pieces(turn_of(s.frame), Ellipse<Vec3>{s.frame.O + s.R * s.frame.X, s.r * s.frame.X, s.r * s.frame.Z}, uv);
}
std::vector<BezierPiece> pieces_of(const Revolution& s, const Box2& uv) { return turned_pieces({s.O, s.Z, 1.0}, s.profile, uv); }

std::vector<BezierPiece> pieces_of(const Extrusion& s, const Box2& uv) {
  std::vector<BezierPiece> pieces;
  for (const auto& span : bezier_spans(s.profile, uv.lo.x, uv.hi.x)) {
    BezierPiece piece;
    piece.u = span.map;
    piece.v = {ParamMap::Kind::affine, uv.lo.y, uv.hi.y};
    piece.patch.pu = static_cast<int>(span.points.size()) - 1;
    piece.patch.pv = 1;
    for (const Vec4& h : span.points)
      for (const double v : {uv.lo.y, uv.hi.y}) piece.patch.net.push_back(h + Vec4(h.w * v * s.direction, 0.0));
    pieces.push_back(std::move(piece));
  }
  return pieces;
}

// The knot spans of one direction that overlap [lo, hi], clipped to it; a span at an end of the domain also serves beyond it.
struct KnotPiece {
  int span;
  double a, b;
};
std::vector<KnotPiece> knot_pieces(const std::vector<double>& knots, int degree, double lo, double hi) {
  std::vector<double> cuts = breakpoints(knots, degree);
  cuts.front() = std::min(cuts.front(), lo);
  cuts.back() = std::max(cuts.back(), hi);
  std::vector<KnotPiece> out;
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    const double a = std::max(cuts[i], lo), b = std::min(cuts[i + 1], hi);
    if (b > a && b - a > 1e-14 * (cuts.back() - cuts.front())) out.push_back({knot_span(knots, degree, 0.5 * (a + b)), a, b});
  }
  return out;
}

// Along v first, for all rows of poles.
std::vector<BezierPiece> pieces_of(const NurbsSurface& s, const Box2& uv) {
  std::vector<BezierPiece> pieces;
  const auto us = knot_pieces(s.knots_u, s.degree_u, uv.lo.x, uv.hi.x);
  const auto vs = knot_pieces(s.knots_v, s.degree_v, uv.lo.y, uv.hi.y);
  const std::size_t across = static_cast<std::size_t>(s.degree_v) + 1, columns = across * vs.size();
  std::vector<Vec4> rows(static_cast<std::size_t>(s.count_u) * columns);
  for (std::size_t k = 0; k < vs.size(); ++k) {
    const SpanBlossom blossom(s.knots_v, s.degree_v, vs[k].span, vs[k].a, vs[k].b);
    for (std::size_t i = 0; i < static_cast<std::size_t>(s.count_u); ++i)
      blossom.points(&s.poles[i * s.count_v + blossom.first_pole()], 1, &rows[i * columns + k * across], 1);
  }
  pieces.reserve(us.size() * vs.size());
  for (const KnotPiece& ku : us) {
    const SpanBlossom blossom(s.knots_u, s.degree_u, ku.span, ku.a, ku.b);
    for (std::size_t k = 0; k < vs.size(); ++k) {
      BezierPiece& piece = pieces.emplace_back();
      piece.u = {ParamMap::Kind::affine, ku.a, ku.b};
      piece.v = {ParamMap::Kind::affine, vs[k].a, vs[k].b};
      piece.patch.pu = s.degree_u;
      piece.patch.pv = s.degree_v;
      piece.patch.net.resize((static_cast<std::size_t>(s.degree_u) + 1) * across);
      for (std::size_t j = 0; j < across; ++j)
        blossom.points(&rows[blossom.first_pole() * columns + k * across + j], columns, &piece.patch.net[j], across);
    }
  }
  return pieces;
}

std::vector<BezierPiece> pieces_of(const PatchChart& s, const Box2& uv) { return pieces_of(*s.near, uv); }

}  // namespace

std::vector<BezierPiece> bezier_pieces(const AnySurface& surface, const Box2& uv) {
  return std::visit([&](const auto& s) { return pieces_of(s, uv); }, surface);
}

}  // namespace iso
