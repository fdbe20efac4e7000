// Whether triangles over shared points make a closed, oriented manifold surface; for any triangles, ours or foreign. What is found is
// counted, and the first few places are named. Same input, same report, for any number of threads; O(n log n).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "patches/triangle_mesh.h"

namespace iso {

struct MeshPlace {
  Point3 at{0.0};              // the point, the middle of the edge or of the triangle
  std::int64_t triangle = -1;  // the first one concerned; -1: none
  int face = -1;               // its face, where faces are known
};

// One kind of finding.
struct Finding {
  static constexpr std::size_t kPlaces = 8;
  std::uint64_t count = 0;
  std::vector<MeshPlace> places;  // the first ones, at most kPlaces

  void add(const MeshPlace& place) {
    if (count++ < kPlaces) places.push_back(place);
  }
};

struct TopologyReport {
  std::uint64_t points = 0, triangles = 0, edges = 0;
  // Places are told apart by index of point, not by coordinates: see `joined_points`. Triangles with a point twice have no area and take no
  // further part.
  Finding open_edges;           // used by one triangle
  Finding non_manifold_edges;   // used by more than two
  Finding misoriented_edges;    // used by two that run the same way
  Finding non_manifold_points;  // whose triangles form more than one fan
  Finding zero_area;            // a point twice, or a height within the rounding of the coordinates (kHeightRounding)
  Finding duplicates;           // triangles with the same three points as one before
  Finding isolated_points;      // of no triangle
  Finding t_junctions;          // ends of open edges that lie inside another open edge, within the distance asked for

  // A closed, oriented manifold without T-junctions, duplicates and triangles without area; isolated points are allowed.
  bool closed() const { return open_edges.count == 0 && sound(); }
  // The same with a border.
  bool sound() const;
};

// A triangle has no area if its height over its longest edge is at most this times the largest coordinate of its corners: the heights that
// rounding of the three points, half an epsilon for each coordinate, can bring about are below that.
inline constexpr double kHeightRounding = 4 * kEps;

// An open edge: corner k and the next one of a triangle.
struct OpenEdge {
  std::uint32_t triangle = 0;
  int corner = 0;
};

struct TopologyOptions {
  double t_junction_distance = 0;  // a point nearer than this to an open edge, and farther from its ends, lies inside it; 0: rounding only,
                                   // 16 epsilon times the largest coordinate
};

// Indices must be valid and coordinates finite (ISO_CHECK). `open_edges`, if given, receives all open edges in order.
TopologyReport check_topology(std::span<const Point3> points, std::span<const PointTriangle> triangles, const TopologyOptions& options = {},
                              std::vector<OpenEdge>* open_edges = nullptr);

// Whether a triangle has no area in the sense of the report.
bool has_no_area(const Point3& a, const Point3& b, const Point3& c);

// For each point the first one with the same coordinates (0 and -0 are the same): joins a soup of triangles at equal places.
std::vector<std::uint32_t> joined_points(std::span<const Point3> points);

}  // namespace iso
