#include "tests/support/cgal_oracle.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/MP_Float.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>

namespace iso::test {
namespace {

using Exact = CGAL::Simple_cartesian<CGAL::MP_Float>;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Vertices = CGAL::Triangulation_vertex_base_with_info_2<std::uint32_t, Kernel>;
using Faces = CGAL::Constrained_triangulation_face_base_2<Kernel>;
using Cdt = CGAL::Constrained_Delaunay_triangulation_2<Kernel, CGAL::Triangulation_data_structure_2<Vertices, Faces>>;

Exact::Point_2 exact(const Vec2& p) { return {p.x, p.y}; }

}  // namespace

int cgal_orientation(const Vec2& a, const Vec2& b, const Vec2& c) { return CGAL::orientation(exact(a), exact(b), exact(c)); }

int cgal_circle_side(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  return CGAL::side_of_oriented_circle(exact(a), exact(b), exact(c), exact(d));
}

std::vector<PlaneEdge> cgal_triangulation(std::span<const Vec2> points, std::span<const std::array<std::uint32_t, 2>> segments) {
  Cdt cdt;
  std::vector<Cdt::Vertex_handle> handles;
  for (const Vec2& p : points) {
    handles.push_back(cdt.insert({p.x, p.y}));
    handles.back()->info() = static_cast<std::uint32_t>(handles.size() - 1);
  }
  for (const auto& [a, b] : segments) cdt.insert_constraint(handles[a], handles[b]);
  std::vector<PlaneEdge> edges;
  for (auto e = cdt.finite_edges_begin(); e != cdt.finite_edges_end(); ++e) {
    const std::uint32_t a = e->first->vertex(cdt.cw(e->second))->info(), b = e->first->vertex(cdt.ccw(e->second))->info();
    edges.push_back({std::min(a, b), std::max(a, b), cdt.is_constrained(*e)});
  }
  std::sort(edges.begin(), edges.end());
  return edges;
}

std::vector<PlaneEdge> edges_of(const Triangulation& all) {
  std::vector<PlaneEdge> edges;
  for (const auto& t : all.triangles())
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = t.v[(k + 1) % 3], b = t.v[(k + 2) % 3];
      if (t.next[k] == Triangulation::kNone || a < b) edges.push_back({std::min(a, b), std::max(a, b), (t.constrained >> k & 1) != 0});
    }
  std::sort(edges.begin(), edges.end());
  return edges;
}

}  // namespace iso::test
