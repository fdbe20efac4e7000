// How near lines pass to the edges of a part: for telling whether a doubtful hit is the file's doing.
#pragma once

#include <vector>

#include "patches/brep.h"

namespace iso::test {

// Distance of p from the line through o along the unit vector d.
inline double distance_to_line(const Vec3& p, const Vec3& o, const Vec3& d) { return glm::length(glm::cross(p - o, d)); }

// The least distance between a line and what a trim curve traces on its face: the best of many samples, then ever smaller steps around each
// sample that is a local minimum.
inline double distance_to_curve(const Face& face, const TrimCurve& curve, const Vec3& o, const Vec3& d) {
  constexpr int kSamples = 256;
  const auto at = [&](double share) {
    return distance_to_line(point(face.surface, jet(curve.curve, curve.t0 + share * (curve.t1 - curve.t0)).C), o, d);
  };
  std::vector<double> samples;
  for (int i = 0; i <= kSamples; ++i) samples.push_back(at(static_cast<double>(i) / kSamples));
  double least = kInf;
  for (int i = 0; i <= kSamples; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if ((i > 0 && samples[k - 1] < samples[k]) || (i < kSamples && samples[k + 1] < samples[k])) continue;
    double best = samples[k], share = static_cast<double>(i) / kSamples;
    for (double step = 0.5 / kSamples; step > 1e-16; step *= 0.5)
      for (const double s : {share - step, share + step})
        if (s >= 0 && s <= 1)
          if (const double here = at(s); here < best) {
            best = here;
            share = s;
          }
    least = std::min(least, best);
  }
  return least;
}

// Whether a line, in the part's coordinates, passes some edge within `more` plus what the file allows there.
inline bool passes_an_edge(const Part& part, const Vec3& o, const Vec3& d, double more) {
  for (const Face& face : part.faces)
    for (const TrimLoop& loop : face.loops)
      for (const TrimCurve& curve : loop.curves) {
        double allowed = more;
        if (curve.edge >= 0) {
          const Edge& edge = part.edges[static_cast<std::size_t>(curve.edge)];
          allowed += std::max(edge.file_tolerance, edge.closing);
        }
        if (distance_to_curve(face, curve, o, d) <= allowed) return true;
      }
  return false;
}

}  // namespace iso::test
