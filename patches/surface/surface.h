// The native surfaces of CAD faces, in the parametrisation of their file, each one plain data. `Frame` is orthonormal, right- or
// left-handed.
//   plane       S = O + u X + v Y
//   cylinder    S = O + r (cos u X + sin u Y) + v Z
//   cone        S = O + (r + v sin a) (cos u X + sin u Y) + v cos a Z        (a: half angle, |a| < pi/2; r >= 0: radius at v = 0)
//   sphere      S = O + r cos v (cos u X + sin u Y) + r sin v Z              (-pi/2 <= v <= pi/2)
//   torus       S = O + (R + r cos v) (cos u X + sin u Y) + r sin v Z        (R < r: spindle; R = r: horn)
//   extrusion   S = C(u) + v D                                               (D need not be a unit vector)
//   revolution  S = C(v) turned by the angle u about the axis (O, Z)
//   NURBS       rational tensor-product B-spline
//   chart       of a patch with any number of sides (patch_chart.h)
// The first eight are exact; so are their rational Bezier pieces, which carry a closed-form map back to the native (u, v). Pieces of charts
// are those of the spline beside them (distance_of_pieces).
#pragma once

#include <memory>
#include <variant>
#include <vector>

#include "patches/base/affine.h"
#include "patches/base/jet.h"
#include "patches/curve/curve.h"
#include "patches/surface/patch_chart.h"

namespace iso {

struct Frame {
  Vec3 O{0.0}, X{1, 0, 0}, Y{0, 1, 0}, Z{0, 0, 1};
};
struct Plane {
  Frame frame;
};
struct Cylinder {
  Frame frame;
  double r = 1;
};
struct Cone {
  Frame frame;
  double r = 1, half_angle = 0;
};
struct Sphere {
  Frame frame;
  double r = 1;
};
struct Torus {
  Frame frame;
  double R = 1, r = 0.25;
};
struct Extrusion {
  Curve3 profile;
  Vec3 direction{0, 0, 1};
  Range u;  // domain of the profile; infinite ends allowed for lines and parabolas
};
struct Revolution {
  Curve3 profile;
  Vec3 O{0.0}, Z{0, 0, 1};  // Z is a unit vector
  Range v;                  // domain of the profile
};

// poles[i * count_v + j]; the usual relations hold per direction (see NurbsCurve); not periodic: closed surfaces are written out.
struct NurbsSurface {
  int degree_u = 0, degree_v = 0;
  int count_u = 0, count_v = 0;
  std::vector<double> knots_u, knots_v;
  std::vector<Vec4> poles;
  bool closed_u = false, closed_v = false;  // S(u0, v) = S(u1, v): parameters may be wrapped by the width of the domain

  bool rational() const;
};

using AnySurface = std::variant<Plane, Cylinder, Cone, Sphere, Torus, Extrusion, Revolution, NurbsSurface, PatchChart>;

// "plane", "cylinder", ...
const char* kind_name(const AnySurface& surface);

// Says what is wrong with the data (sizes, knots, weights, non-finite numbers, non-positive radii), or nothing (empty).
std::string problem_of(const AnySurface& surface);

// The natural domain; ends may be infinite. Angles: [0, 2 pi]; sphere v: [-pi/2, pi/2].
Box2 natural_domain(const AnySurface& surface);

// The period in u and in v; 0 where the surface does not close.
Vec2 periods(const AnySurface& surface);

// Point with first and second derivatives at (u, v). Angles may be any; a NURBS is continued by its end spans.
Jet2 jet2(const AnySurface& surface, UV uv);
Point3 point(const AnySurface& surface, UV uv);

// The size of the numbers that a point S of the surface is added up from: a frame far away, a large radius. The rounding of S is a small
// multiple of it. 0 for a NURBS, whose poles are no larger than the surface.
double size_of_terms(const AnySurface& surface, const Point3& S);

// Moves the surface by an affine similarity that is exact for these kinds: translation only.
void translate(AnySurface& surface, const Vec3& by);

// The unit normal Su x Sv / |...|; where that vanishes (poles, collapsed sides, apexes) its limit from inside `domain`
// [Safko 2022, 5.1], from derivatives where they decide, else from points ever nearer. Zero only if no limit can be found.
Vec3 unit_normal(const AnySurface& surface, UV uv, const Box2& domain);

// Principal curvatures k1 >= k2 with respect to `normal`; positive where the surface bends toward it. NaN at singular points.
struct Curvatures {
  double k1, k2;
};
Curvatures principal_curvatures(const Jet2& jet, const Vec3& normal);

// The shape operator, extended to space: dn = -S dp for a step dp along the surface, S n = 0. Symmetric; along the surface its eigenvalues
// are the principal curvatures. NaN at singular points.  [do Carmo 1976, 3-3]
Mat3 shape_operator(const Jet2& jet, const Vec3& normal);

// Whether `bounds` is one interval evaluation (plane, cylinder, cone, sphere, torus) rather than the hull of all Bezier pieces.
bool has_closed_form_bounds(const AnySurface& surface);

// No point of the surface is farther than this from its Bezier pieces at the same (u, v); 0 for all but charts of blended patches.
double distance_of_pieces(const AnySurface& surface);

// A guaranteed box of S over `uv` (finite).
Box3 bounds(const AnySurface& surface, const Box2& uv);

}  // namespace iso
