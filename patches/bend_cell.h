// Bounds of the second derivatives over one cell: in closed form, of a rational Bezier patch, or of a piece of a surface of revolution.
// The parts of `BendTree`.
#pragma once

#include <optional>

#include "patches/bend.h"
#include "patches/surface/bezier_patch.h"

namespace iso {

// Nothing is known but the suprema.
inline constexpr Range kEverything{-kInf, kInf};
// Nothing is known at all.
Bend unbounded_bend();

// Plane, cylinder, cone, sphere, torus, and extrusions of lines and conics: exact over the box. Nothing for the other kinds.
std::optional<Bend> closed_form_bend(const AnySurface& surface, const Box2& uv);
bool has_closed_form_bend(const AnySurface& surface);

// A bound of the absolute normal curvature from first derivatives about (Su, Sv), strays at most (stray_u, stray_v) long, and the ranges of
// the second form. Infinite if the strays may make the first form singular.
double curvature_bound(const Vec3& Su, const Vec3& Sv, double stray_u, double stray_v, const Bend& bend);

// Knots between pieces across which the first derivative jumps by more than rounding; `size`: of the coordinates. The pieces are a grid, u
// outside; `size` of a jump: the supremum of |S+ - S-| along the knot.
std::vector<KnotJump> knot_jumps(const std::vector<BezierPiece>& pieces, int count_u, int count_v, int direction, double size);
std::vector<KnotJump> knot_jumps(const std::vector<BezierSpan<Vec3>>& spans, double size);

// The same from least lengths of Su and Sv and the largest absolute cosine between them: better over long pieces whose tangents turn much.
double curvature_bound(double least_u, double least_v, double cosine, const Bend& bend);

// A net of homogeneous coefficients, like that of BezierPatch; of any degree from 0.
struct HomogeneousNet {
  int pu = 0, pv = 0;
  std::vector<Vec4> c;
};

// Bounds over the unit square of a patch with positive weights, for derivatives by the unit parameters. The object keeps its memory from
// call to call.
class PatchBend {
 public:
  struct Result {
    Bend bend;
    bool bounded = false;             // whether the normal is
    double turn = 0;                  // the larger half angle of the cones of Su and Sv, by its tangent
    double along_s = 0, along_t = 0;  // how much a division in each direction promises
  };
  // `rounding`: of the coordinates of the net.
  Result bound(const BezierPatch& patch, bool rational, double rounding);

 private:
  // First derivatives: a ball that holds them, and the cone about `axis` by its least length and the tangent of its half angle.
  struct Tangents {
    Vec3 centre{0.0}, axis{0.0};
    double stray = 0, least = 0, tangent = kInf;
  };

  void load(const BezierPatch& patch);
  void subtract_model(const BezierPatch& patch, Vec3& A, Vec3& B);
  void set_weights();
  Tangents tangents(const HomogeneousNet& net, double slope, double rounding);
  double supremum(const HomogeneousNet& net, const HomogeneousNet& wa, const Vec3& A, const HomogeneousNet& wb, const Vec3& B) const;
  void bound_lengths(const Tangents& u, const Tangents& v, double rounding, Bend& bend) const;
  bool set_normals();
  Range along_normal(const HomogeneousNet& net);
  bool bound_second_form(const Tangents& u, const Tangents& v, double rounding, Bend& bend);
  void promise(Result& result) const;

  bool rational_ = false;
  HomogeneousNet S_, Su_, Sv_, Suu_, Suv_, Svv_;  // where rational: all of one degree, without the linear model
  HomogeneousNet raised_;
  std::vector<double> inverse_w_, inverse_raised_w_;      // weights of that degree, and of one more
  double radius_ = 0;                                     // of S about the linear model
  double wu_ = 0, wv_ = 0, wuu_ = 0, wuv_ = 0, wvv_ = 0;  // suprema of the weight's derivatives over the weight
  Vec3 normals_[4];                                       // corners 00, 01, 10, 11
  std::vector<double> rows_;
  std::vector<Vec3> points_;
};

// A curve over an interval: its point and derivatives lie in balls.
struct CurveBalls {
  Vec3 C{0.0}, Ct{0.0}, Ctt{0.0};
  double stray = 0, stray_t = 0, stray_tt = 0;
};
CurveBalls curve_balls(const Curve3& curve, const Range& t);            // not for a NURBS
CurveBalls curve_balls(const std::vector<Vec4>& bezier, double width);  // over the unit interval, which spans `width` of the parameter

// Of the curve turned about the axis through the origin with direction Z.
Bend turned_bend(const CurveBalls& curve, const Vec3& Z);

}  // namespace iso
