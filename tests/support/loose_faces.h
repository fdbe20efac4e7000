// Parts whose faces share no edges, as files without topology give them.
#pragma once

#include <vector>

#include "patches/brep.h"
#include "tests/support/random_shapes.h"

namespace iso::test {

// A line in (u, v) as a quadratic whose parameter runs unevenly: `middle` in (0, 1) is the place that the middle pole takes.
inline NurbsCurve<Vec2> uneven_line(const UV& from, const UV& to, double middle) {
  NurbsCurve<Vec2> curve;
  curve.degree = 2;
  curve.knots = {0, 0, 0, 1, 1, 1};
  curve.poles = {homogeneous(from, 1), homogeneous(from + middle * (to - from), 1), homogeneous(to, 1)};
  return curve;
}

struct LooseFaces {
  Part part;
  double file_tolerance = 0;

  void add_edge(TrimLoop& loop, Curve2 curve, double t0, double t1) {
    loop.curves.push_back({std::move(curve), t0, t1, static_cast<int>(part.edges.size())});
    part.edges.push_back({1, false, file_tolerance, 0, 0});
  }

  // From `from` to `to`, along or against its parameter.
  void add_line(TrimLoop& loop, const UV& from, const UV& to, bool along = true) {
    const UV &a = along ? from : to, &b = along ? to : from;
    add_edge(loop, Line<Vec2>{a, b - a}, along ? 0 : 1, along ? 1 : 0);
  }

  Face& add_face(const AnySurface& surface, std::vector<TrimLoop> loops, const Box2& domain) {
    Face face;
    face.surface = surface;
    face.loops = std::move(loops);
    face.domain = domain;
    part.box.include(bounds(surface, domain).lo);
    part.box.include(bounds(surface, domain).hi);
    part.faces.push_back(std::move(face));
    return part.faces.back();
  }

  // A polygon, counter-clockwise, in a plane.
  Face& add_polygon(const std::vector<UV>& corners, const Plane& plane = {}, bool along = true) {
    TrimLoop loop;
    Box2 domain;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      add_line(loop, corners[i], corners[(i + 1) % corners.size()], along);
      domain.include(corners[i]);
    }
    return add_face(plane, {loop}, domain);
  }

  Face& add_rectangle(const UV& lo, const UV& hi, const Plane& plane = {}, bool along = true) {
    return add_polygon({lo, {hi.x, lo.y}, hi, {lo.x, hi.y}}, plane, along);
  }
};

// The bilinear surface of four corners: S(0,0), S(1,0), S(0,1), S(1,1).
inline NurbsSurface bilinear(const Point3& p00, const Point3& p10, const Point3& p01, const Point3& p11) {
  NurbsSurface s;
  s.degree_u = s.degree_v = 1;
  s.count_u = s.count_v = 2;
  s.knots_u = s.knots_v = {0, 0, 1, 1};
  s.poles = {homogeneous(p00, 1), homogeneous(p01, 1), homogeneous(p10, 1), homogeneous(p11, 1)};
  return s;
}

// A closed ring of rows x columns bilinear patches; each patch divides each of its sides into edges by itself, at random, and has each
// corner up to `apart` (in each coordinate) beside where it should be.
inline LooseFaces random_ring(Random& random, int rows, int columns, double apart = 0) {
  std::vector<Point3> grid;
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j) {
      const double a = kTwoPi * (i + between(random, -0.3, 0.3)) / rows, b = kTwoPi * (j + between(random, -0.3, 0.3)) / columns;
      const double r = 3 + between(random, 0.8, 1.2) * std::cos(b);
      grid.push_back({r * std::cos(a), r * std::sin(a), between(random, 0.8, 1.2) * std::sin(b)});
    }
  const auto at = [&](int i, int j) {
    return grid[static_cast<std::size_t>((i % rows) * columns + j % columns)] + random_vector<Vec3>(random, apart);
  };
  LooseFaces faces;
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j) {
      const std::array<UV, 4> corners{UV(0, 0), UV(1, 0), UV(1, 1), UV(0, 1)};
      TrimLoop loop;
      for (std::size_t k = 0; k < 4; ++k) {
        const UV from = corners[k], to = corners[(k + 1) % 4];
        double s = 0;
        for (int left = whole(random, 0, 3); s < 1; --left) {
          const double next = left <= 0 ? 1 : s + (1 - s) * between(random, 0.1, 0.9);
          const UV a = from + s * (to - from), b = next == 1 ? to : from + next * (to - from);
          switch (whole(random, 0, 2)) {
            case 0:
              faces.add_line(loop, a, b);
              break;
            case 1:
              faces.add_line(loop, a, b, false);
              break;
            default:
              faces.add_edge(loop, uneven_line(a, b, between(random, 0.2, 0.8)), 0, 1);
          }
          s = next;
        }
      }
      faces.add_face(bilinear(at(i, j), at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)), {loop}, {UV(0, 0), UV(1, 1)});
    }
  return faces;
}

}  // namespace iso::test
