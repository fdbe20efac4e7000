// Uniform tessellations of a polygon's domain, for patches with any number of sides [Hettinga 2021, 5.8.1].
//
// The regular polygon (patch_basis.h) is divided into sub-polygons, each of them evenly by its level: a triangle of level m into m^2
// triangles, a quadrilateral, bilinearly, into m^2 quads, which are cut in two from its first corner toward the opposite one. A fan goes
// out from corner 0; the symmetric divisions share the centre. Quads take three consecutive corners and one more point, so they need an
// even number of sides. [5.8.1 prints n/2 - 2 quads of a fan; n/2 - 1 fill the polygon.] With an odd number a fan ends in one triangle, and
// the symmetric division is that into triangles.
//
//   fan_triangles         n - 2 triangles (v_0, v_k, v_(k+1))
//   fan_quads             n/2 - 1 quads (v_0, v_(2k+1), v_(2k+2), v_(2k+3)); n odd: (n - 3)/2 and a triangle
//   symmetric_triangles   n triangles (centre, v_k, v_(k+1))
//   symmetric_quads       n/2 quads (centre, v_(2k), v_(2k+1), v_(2k+2)); n odd: as symmetric_triangles
//
// A side may have a level of its own, so that neighbours agree on it [5.8.2]: then the outermost ring of the sub-polygon is replaced by
// strips between the side's points and the next row, as graphics hardware does; of a level too low for a ring only the middle is left.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "patches/surface/patch_basis.h"

namespace iso {

enum class Strategy : std::uint8_t { fan_triangles, fan_quads, symmetric_triangles, symmetric_quads };
inline constexpr std::array kStrategies{Strategy::fan_triangles, Strategy::fan_quads, Strategy::symmetric_triangles,
                                        Strategy::symmetric_quads};
const char* name_of(Strategy strategy);  // "fan-triangles", ...

inline constexpr int kMostLevel = 512;

// Levels are 1 to kMostLevel (ISO_CHECK).
struct PatternLevels {
  int inner = 1;
  std::vector<int> of_side;  // side k runs from v_(k-1) to v_k; empty: all as `inner`

  auto operator<=>(const PatternLevels&) const = default;
};

// A point of the polygon in the chart of a corner.
struct ChartPlace {
  int corner = 0;
  Vec2 st{0.0};
};

// The chart that holds a point of the polygon, and its place there: the bilinear map of the chart inverted in closed form. Points on a side
// have t = 0 or s = 0, on a spoke s = 1 or t = 1, the centre (1, 1), exactly, if they are within 1e-12 of it.
ChartPlace chart_place(int sides, const Vec2& point);
// The same in the chart of this corner, wherever the point is; held within [0, 1]^2.
Vec2 place_in_chart(int sides, int corner, const Vec2& point);
// The place of a point in the neighbouring chart that has it, too: on the spoke between them, or the centre. Else it must be in it already.
Vec2 seen_from(int sides, const ChartPlace& place, int corner);

struct DomainPattern {
  int sides = 0;
  std::vector<Vec2> points;
  std::vector<ChartPlace> places;  // in symmetric patterns the same s and t, bit for bit, for points that are each other's when turned
  std::vector<std::array<std::uint32_t, 3>> triangles;  // counter-clockwise
  std::vector<std::vector<std::uint32_t>> of_side;      // from v_(k-1) to v_k, both included; even along the side
  std::uint64_t quads = 0;                              // of which pairs of triangles are the halves
};
DomainPattern domain_pattern(Strategy strategy, int sides, const PatternLevels& levels);

// The weights of all control points at places of the polygon, those of a pattern, and their derivatives in the chart of each point: they
// depend on the basis and the places only, so many patches share one table, and a patch is a matrix times its control points. Points that
// are at one place of their charts share a row: with symmetric patterns the table is that of one sector, and the control points are turned
// [Hettinga 2021, 5.8.1].
class CoordinateTable {
 public:
  CoordinateTable(const PatchBasis& basis, std::span<const ChartPlace> places);

  struct At {
    Vec3 S{0.0}, Ss{0.0}, St{0.0};
  };
  // points.size() == point_count(basis); `weights`: of rational Bezier triangles, else empty.
  std::vector<At> evaluate(std::span<const Vec3> points, std::span<const double> weights = {}) const;
  // Places alone.
  std::vector<Vec3> places(std::span<const Vec3> points, std::span<const double> weights = {}) const;

  std::size_t rows() const { return rows_; }
  std::size_t bytes() const { return 3 * W_.size() * sizeof(double); }

 private:
  PatchBasis basis_;
  std::size_t rows_ = 0, columns_ = 0;
  std::vector<double> W_, Ws_, Wt_;  // row by row
  struct Use {
    std::uint32_t row = 0;
    int corner = 0;
  };
  std::vector<Use> uses_;  // of the places
};

}  // namespace iso
