// Solids made by formula, as parts with shared edges, at any place and size; each knows its distance function.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "patches/brep.h"
#include "tests/support/grid_cube.h"
#include "tests/support/smooth_tori.h"
#include "tests/support/tessellation_check.h"

namespace iso::test {

struct SolidPart {
  std::string name;
  Part part;
  double size = 1;
  // Distance of a point near a face from the face's analytic surface, one for each face.
  std::vector<std::function<double(const Point3&)>> distance;
};

inline Point3 in_frame(const Frame& f, const Point3& p) {
  const Vec3 d = p - f.O;
  return {glm::dot(d, f.X), glm::dot(d, f.Y), glm::dot(d, f.Z)};
}

inline TrimCurve straight(const UV& from, const UV& to, int edge) {
  TrimCurve c;
  c.curve = Line<Vec2>{from, to - from};
  c.edge = edge;
  return c;
}

// In a mirrored frame Su x Sv points the other way.
inline bool mirrored(const Frame& f) { return glm::dot(glm::cross(f.X, f.Y), f.Z) < 0; }

// A plane across the frame's axis at height z, inside the circle of radius r; its edge is run through from 0 to 2 pi.
inline void add_cap(SolidPart& s, const Frame& frame, double z, double r, bool top, int edge) {
  Frame at = frame;
  at.O += z * frame.Z;
  Face face;
  face.surface = Plane{at};
  face.domain = {Vec2(-r), Vec2(r)};
  face.reversed = top == mirrored(frame);
  TrimCurve circle;
  circle.curve = Ellipse<Vec2>{Vec2(0), Vec2(r, 0), Vec2(0, r)};
  circle.t1 = kTwoPi;
  circle.edge = edge;
  face.loops.push_back({{circle}});
  s.part.faces.push_back(std::move(face));
  s.distance.push_back([at](const Point3& p) { return std::abs(in_frame(at, p).z); });
}

// A face around the axis from v = 0 to v = height: edges 0 (below), 1 (the seam), 2 (above, perhaps a point).
inline Face around(AnySurface surface, double height, const Frame& frame) {
  Face face;
  face.surface = std::move(surface);
  face.domain = {{0, 0}, {kTwoPi, height}};
  face.reversed = mirrored(frame);
  TrimCurve below, above;
  below.curve = Line<Vec2>{{0, 0}, {1, 0}};
  below.t1 = above.t0 = kTwoPi;
  below.edge = 0;
  above.curve = Line<Vec2>{{0, height}, {1, 0}};
  above.t1 = 0;
  above.edge = 2;
  TrimCurve up, down;
  up.curve = Line<Vec2>{{kTwoPi, 0}, {0, 1}};
  down.curve = Line<Vec2>{{0, 0}, {0, 1}};
  up.t1 = down.t0 = height;
  down.t1 = 0;
  up.edge = down.edge = 1;
  face.loops.push_back({{below, up, above, down}});
  return face;
}

inline SolidPart solid_cylinder(const Frame& frame, double size) {
  SolidPart s{"cylinder", {}, size, {}};
  const double r = 0.5 * size;
  s.part.edges = {{2, false, 0, 0, 0}, {2, false, 0, 0, 0}, {2, false, 0, 0, 0}};
  s.part.faces.push_back(around(Cylinder{frame, r}, size, frame));
  s.distance.push_back([=](const Point3& p) { return std::abs(glm::length(Vec2(in_frame(frame, p))) - r); });
  add_cap(s, frame, 0, r, false, 0);
  add_cap(s, frame, size, r, true, 2);
  return s;
}

// With its apex at height `size`.
inline SolidPart solid_cone(const Frame& frame, double size) {
  SolidPart s{"cone", {}, size, {}};
  const double r = 0.5 * size, angle = std::atan2(r, size);
  s.part.edges = {{2, false, 0, 0, 0}, {2, false, 0, 0, 0}, {1, true, 0, 0, 0}};
  s.part.faces.push_back(around(Cone{frame, r, -angle}, std::hypot(r, size), frame));
  s.distance.push_back([=](const Point3& p) {
    const Vec3 q = in_frame(frame, p);
    return std::abs(glm::length(Vec2(q)) - (r - q.z * std::tan(angle))) * std::cos(angle);
  });
  add_cap(s, frame, 0, r, false, 0);
  return s;
}

inline SolidPart untrimmed(std::string name, AnySurface surface, const Box2& domain, double size,
                           std::function<double(const Point3&)> distance, bool reversed = false) {
  SolidPart s{std::move(name), {}, size, {std::move(distance)}};
  Face face;
  face.surface = std::move(surface);
  face.domain = domain;
  face.reversed = reversed;
  s.part.faces.push_back(std::move(face));
  return s;
}

inline SolidPart solid_sphere(const Frame& frame, double size) {
  const double r = 0.5 * size;
  return untrimmed(
      "sphere", Sphere{frame, r}, {{0, -kPi / 2}, {kTwoPi, kPi / 2}}, size,
      [=](const Point3& p) { return std::abs(glm::length(p - frame.O) - r); }, mirrored(frame));
}

inline SolidPart solid_torus(const Frame& frame, double size) {
  const double R = 0.35 * size, r = 0.15 * size;
  return untrimmed(
      "torus", Torus{frame, R, r}, {{0, 0}, {kTwoPi, kTwoPi}}, size,
      [=](const Point3& p) {
        const Vec3 q = in_frame(frame, p);
        return std::abs(std::hypot(glm::length(Vec2(q)) - R, q.z) - r);
      },
      mirrored(frame));
}

inline SolidPart solid_box(const Frame& frame, double size) {
  GridCube cube(1, size, Point3(0.0));
  SolidPart s{"box", std::move(cube.part), size, {}};
  for (Face& face : s.part.faces) {
    Frame& f = std::get<Plane>(face.surface).frame;
    const auto turned = [&](const Vec3& v) { return v.x * frame.X + v.y * frame.Y + v.z * frame.Z; };
    f = {frame.O + turned(f.O), turned(f.X), turned(f.Y), glm::cross(turned(f.X), turned(f.Y))};
    if (mirrored(frame)) face.reversed = !face.reversed;
    s.distance.push_back([f](const Point3& p) { return std::abs(in_frame(f, p).z); });
  }
  return s;
}

// Bicubic, wavy, closed both ways; no distance function.
inline SolidPart solid_bicubic(const Frame& frame, double size) {
  NurbsSurface s = wavy_torus(12, 6);
  for (Vec4& pole : s.poles) {
    const Vec3 p = 0.35 * size * project(pole);
    pole = homogeneous(frame.O + p.x * frame.X + p.y * frame.Y + p.z * frame.Z, 1);
  }
  return untrimmed("bicubic torus", s, natural_domain(s), size, {}, mirrored(frame));
}

// Moved to its own origin, boxes and gaps measured, as readers hand parts out.
inline SolidPart finished(SolidPart s) {
  Model model;
  model.parts.push_back(std::move(s.part));
  model.instances.emplace_back();
  finish(model);
  s.part = std::move(model.parts[0]);
  const Vec3 shift = model.instances[0].to_model.translation;
  for (auto& distance : s.distance)
    if (distance) distance = [distance, shift](const Point3& p) { return distance(p + shift); };
  return s;
}

using MakeSolid = SolidPart (*)(const Frame&, double);
inline const std::vector<MakeSolid> kSolids{solid_cylinder, solid_cone, solid_sphere, solid_torus, solid_box, solid_bicubic};

// Its mesh, which must keep everything (tessellation_check.h).
inline PartTessellation tessellated(const SolidPart& s, double tolerance) {
  constexpr int kSamples = 100;
  PartTessellation made = tessellate(s.part, {tolerance});
  Random random(1);
  for (const Defect& d : defects_of(s.part, made, tolerance, kSamples, random))
    ADD_FAILURE() << s.name << " at " << tolerance / s.size << " of its size: " << text_of(d);
  return made;
}

}  // namespace iso::test
