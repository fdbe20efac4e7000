// What `continuity` tells of a model: every edge of every part with its class, the table, the JSON (continuity_report.md describes it), and
// which limits are not kept.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "patches/brep.h"
#include "tess/continuity.h"

namespace iso {

// Values by Measure: world units, radians, one over world units; `off` has none.
struct ContinuitySettings {
  Measure by = Measure::normal;
  std::array<double, 4> tolerance{};
  std::array<std::optional<double>, 4> limit{};
  bool fail_open = false;
  double sew = 0;
  int rows = 20;
  std::optional<double> scale;  // of the picture: the upper end
};

// How far two faces are continuous along an edge, within the tolerances; each class asks for those before it.
enum class ContinuityClass { apart, G0, G1, G2, unknown };
inline constexpr std::array<const char*, 5> kContinuityClassNames{"apart", "G0", "G1", "G2", "unknown"};

// Edges that are free, non-manifold or degenerate are `unknown`; so are those without a normal. Where a curvature is not known anywhere
// along an edge, it is at most G1.
ContinuityClass class_of(const EdgeContinuity& edge, const ContinuitySettings& settings);

struct PartContinuity {
  const Part* part = nullptr;
  Affine3 to_model;    // the first place where the part stands
  int placements = 0;  // none: the part's own coordinates
  Continuity continuity;
};

struct ContinuityReport {
  std::string version, file, unit;
  double diagonal = 0;
  ContinuitySettings settings;
  std::vector<PartContinuity> parts;  // those of the model
};

// Edges are measured once for each part: placements are rigid.
ContinuityReport report_of(const Model& model, const ContinuitySettings& settings);

// Edges of all parts, each part once.
struct ContinuityTotals {
  long faces = 0, copies = 0, sewn = 0, misoriented = 0;
  std::array<long, kEdgeKindNames.size()> kinds{};           // by EdgeKind
  std::array<long, kContinuityClassNames.size()> classes{};  // by ContinuityClass, of edges between two faces and seams
};
ContinuityTotals totals_of(const ContinuityReport& report);

// The largest value of a measure; of curvature only where faces are tangent within the tolerance. Zero if there is none.
double largest(const ContinuityReport& report, Measure measure);

// "0.0123 mm", "0.5 deg", "0.02 /mm".
std::string value_text(double value, Measure measure, const std::string& unit);

std::string continuity_table(const ContinuityReport& report);
std::string continuity_json(const ContinuityReport& report);  // numbers that are not finite are null

// One line for each limit that is not kept.
std::vector<std::string> broken_limits(const ContinuityReport& report);

}  // namespace iso
