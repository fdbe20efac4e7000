// What every model that a reader hands out must keep, whatever the file held.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "patches/brep.h"

namespace iso::test {

// The first promise that the model breaks, or nothing.
inline std::string unsound(const Model& model) {
  const auto finite_box = [](const Box3& box) { return !box.empty() && finite(box.lo) && finite(box.hi); };
  std::size_t faces = 0;
  for (const Instance& instance : model.instances) {
    if (instance.part < 0 || static_cast<std::size_t>(instance.part) >= model.parts.size()) return "an instance of no part";
    if (!finite(instance.to_model.translation) || !(std::abs(glm::determinant(instance.to_model.linear)) > 0))
      return "a placement that is singular or not finite";
    faces += model.parts[static_cast<std::size_t>(instance.part)].faces.size();
  }
  if (faces == 0) return "no faces";
  for (const Part& part : model.parts) {
    for (std::size_t f = 0; f < part.faces.size(); ++f) {
      const Face& face = part.faces[f];
      const auto wrong = [&](const std::string& what) { return fmt::format("face {} '{}': {}", f, face.name, what); };
      // Readers take numbers up to 1e15; moving the part to its origin may make products with large weights a little larger.
      if (const std::string problem = problem_of(face.surface); !problem.empty() && problem.find("larger than") == problem.npos)
        return wrong(problem);
      if (face.domain.empty() || !finite(face.domain.lo) || !finite(face.domain.hi)) return wrong("its domain is empty or not finite");
      if (!finite(point(face.surface, face.domain.middle()))) return wrong("its middle is not finite");
      for (const TrimLoop& loop : face.loops) {
        if (loop.curves.empty()) return wrong("a loop without curves");
        for (const TrimCurve& curve : loop.curves) {
          if (curve.edge >= static_cast<int>(part.edges.size())) return wrong("a trim curve of an edge that does not exist");
          if (!std::isfinite(curve.t0) || !std::isfinite(curve.t1)) return wrong("a trim curve without end");
          if (!finite(jet(curve.curve, curve.t0).C) || !finite(jet(curve.curve, curve.t1).C))
            return wrong("a trim curve that is not finite");
        }
      }
    }
    for (const Edge& edge : part.edges)
      if (!std::isfinite(edge.gap) || !std::isfinite(edge.closing) || !(edge.closing >= 0)) return "an edge whose gap is not finite";
  }
  if (!finite_box(box_of(model))) return "its box is empty or not finite";
  return {};
}

}  // namespace iso::test
