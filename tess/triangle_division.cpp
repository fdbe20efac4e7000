#include "tess/triangle_division.h"

namespace iso {

namespace {

// A step toward the foot must bring it nearer by this share of the tolerance.
constexpr double kWorthwhile = 0.02;
constexpr int kMostSteps = 3;

// A division leaves a quarter of what is not certain, or less where a part bends less than the whole: this share of that is hoped for.
constexpr double kHope = 0.5;

// Tangents whose square of the sine is less than this give no direction.
constexpr double kParallel = 1e-12;

}  // namespace

TriangleDivision::TriangleDivision(const FaceShape& shape, const std::array<SurfaceCorner, 3>& corners, double most)
    : shape_(shape), most_(most) {
  feet_[Place{0, 0}.index()] = {corners[0].S, corners[0], 0};
  feet_[Place{kSide, 0}.index()] = {corners[1].S, corners[1], 0};
  feet_[Place{0, kSide}.index()] = {corners[2].S, corners[2], 0};
  Box2 box;
  for (const SurfaceCorner& corner : corners) box.include(corner.uv);
  place_ = shape.bend().place_of(box);
}

// Newton steps toward the nearest point, as long as they pay: any point of the surface bounds the distance from above.
void TriangleDivision::approach(Foot& foot) const {
  const Box2& domain = shape_.face().domain;
  TangentJet at = shape_.eval().at(foot.at.uv);
  foot.at.S = at.S;
  foot.off = glm::length(foot.x - at.S);
  for (int i = 0; i < kMostSteps && foot.off > kWorthwhile * most_; ++i) {
    const Vec3 r = foot.x - at.S;
    const double E = glm::dot(at.Su, at.Su), F = glm::dot(at.Su, at.Sv), G = glm::dot(at.Sv, at.Sv), det = E * G - F * F;
    if (!(det > kParallel * E * G)) return;
    const double bu = glm::dot(at.Su, r), bv = glm::dot(at.Sv, r);
    const UV step((G * bu - F * bv) / det, (E * bv - F * bu) / det);
    const double along2 = bu * step.x + bv * step.y;  // squared length of the shift along the surface
    if (foot.off - std::sqrt(std::max(0.0, foot.off * foot.off - along2)) < kWorthwhile * most_) return;
    const UV next = glm::clamp(foot.at.uv + step, domain.lo, domain.hi);
    at = shape_.eval().at(next);
    const double off = glm::length(foot.x - at.S);
    if (!(off < foot.off)) return;
    foot.off = off;
    foot.at = {next, at.S};
  }
}

double TriangleDivision::find_foot(const Place& a, const Place& b) {
  Foot& foot = feet_[between(a, b).index()];
  if (foot.off >= 0) return foot.off;
  const Foot &from = feet_[a.index()], &to = feet_[b.index()];
  foot.x = 0.5 * (from.x + to.x);
  foot.at.uv = 0.5 * (from.at.uv + to.at.uv);
  approach(foot);
  return foot.off;
}

double TriangleDivision::bound_of(const Part& part) const {
  const Foot &a = feet_[part[0].index()], &b = feet_[part[1].index()], &c = feet_[part[2].index()];
  Box2 box;
  for (const Foot* foot : {&a, &b, &c}) box.include(foot->at.uv);
  const double over_feet = bound_in(shape_.bend().over(box, place_), {a.at.uv, b.at.uv, c.at.uv}, longest_side(a.at, b.at, c.at));
  return std::max({a.off, b.off, c.off}) + over_feet;
}

FaceShape::Verdict TriangleDivision::verdict(double quick) {
  std::array<Part, kSide * kSide> parts, next;
  std::size_t count = 1;
  parts[0] = {Place{0, 0}, Place{kSide, 0}, Place{0, kSide}};
  double hope = kHope / (kSide * kSide), proven = 0;
  if (!(hope * quick <= most_)) return {false, quick};
  for (int level = 1; level <= kLevels; ++level) {
    hope *= 4;
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t k = 0; k < 3; ++k)
        if (const double off = find_foot(parts[i][k], parts[i][(k + 1) % 3]); off > most_) return {false, off};
    std::size_t left = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const auto& [a, b, c] = parts[i];
      const Place ab = between(a, b), bc = between(b, c), ca = between(c, a);
      for (const Part& part : {Part{a, ab, ca}, Part{ab, b, bc}, Part{ca, bc, c}, Part{ab, bc, ca}}) {
        const double bound = bound_of(part);
        if (bound <= most_) {
          proven = std::max(proven, bound);
          continue;
        }
        double off = 0;
        for (const Place& corner : part) off = std::max(off, feet_[corner.index()].off);
        if (level == kLevels || !(off + hope * (bound - off) <= most_)) return {false, quick};
        next[left++] = part;
      }
    }
    if (left == 0) return {true, proven};
    std::swap(parts, next);
    count = left;
  }
  return {false, quick};
}

}  // namespace iso
