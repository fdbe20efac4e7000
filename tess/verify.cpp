#include "tess/verify.h"

#include <tbb/parallel_for.h>

#include "tess/domain_overlap.h"
#include "tess/free_border.h"

namespace iso {
namespace {

// What was found in one face; triangles by their number in the part.
struct FaceFindings {
  TriangleShapes shapes;
  std::vector<std::uint32_t> folded, turned, overlapping;
  std::vector<bool> is_free;  // of the face's open edges, in order
};

// The nodes and triangles of one face.
struct FaceMesh {
  const Face* face;
  const PartMesh* mesh;
  std::uint32_t node_begin, node_end, begin, end;

  FaceMesh(const Part& part, const PartMesh& m, std::size_t f)
      : face(&part.faces[f]),
        mesh(&m),
        node_begin(m.first_node[f]),
        node_end(m.first_node[f + 1]),
        begin(m.first_triangle[f]),
        end(m.first_triangle[f + 1]) {
    ISO_CHECK(node_begin <= node_end && node_end <= m.nodes.size() && begin <= end && end <= m.triangles.size());
    for (std::uint32_t i = node_begin; i < node_end; ++i)
      ISO_CHECK(m.nodes[i].point < m.points.size() && finite(m.nodes[i].uv) && finite(m.nodes[i].normal));
    for (std::uint32_t t = begin; t < end; ++t)
      for (const std::uint32_t node : m.triangles[t]) ISO_CHECK(node_begin <= node && node < node_end);
  }
};

void check_in_space(const FaceMesh& f, FaceFindings& found) {
  for (std::uint32_t t = f.begin; t < f.end; ++t) {
    const Triangle& triangle = f.mesh->triangles[t];
    const Point3 &a = f.mesh->corner(triangle, 0), &b = f.mesh->corner(triangle, 1), &c = f.mesh->corner(triangle, 2);
    add_shape(found.shapes, a, b, c);
    if (has_no_area(a, b, c)) continue;
    Vec3 normals(0.0);
    for (const std::uint32_t node : triangle) normals += f.mesh->nodes[node].normal;
    if (normals != Vec3(0.0) && glm::dot(glm::cross(b - a, c - a), normals) <= 0) found.folded.push_back(t);
  }
}

void check_in_domain(const FaceMesh& f, bool turned, FaceFindings& found) {
  std::vector<std::array<UV, 3>> triangles;
  triangles.reserve(f.end - f.begin);
  for (std::uint32_t t = f.begin; t < f.end; ++t) {
    const auto& [a, b, c] = f.mesh->triangles[t];
    triangles.push_back({f.mesh->nodes[a].uv, f.mesh->nodes[b].uv, f.mesh->nodes[c].uv});
  }
  const DomainOverlap overlap = domain_overlap(triangles, f.face->reversed != turned ? -1 : 1);
  for (const std::uint32_t t : overlap.turned) found.turned.push_back(f.begin + t);
  for (const auto& pair : overlap.overlapping) found.overlapping.push_back(f.begin + pair[1]);
}

void check_borders(const FaceMesh& f, const MakersNotes& notes, std::span<const OpenEdge> open, FaceFindings& found) {
  for (const OpenEdge& e : open) {
    const Triangle& t = f.mesh->triangles[e.triangle];
    const auto corner = static_cast<std::size_t>(e.corner);
    const auto [a, b] = std::minmax(f.mesh->nodes[t[corner]].point, f.mesh->nodes[t[(corner + 1) % 3]].point);
    found.is_free.push_back(std::binary_search(notes.free_sides.begin(), notes.free_sides.end(), std::array{a, b}));
  }
}

void check_borders(const FaceMesh& f, const Part& part, std::span<const OpenEdge> open, FaceFindings& found) {
  if (open.empty()) return;
  const NodePairs free = free_neighbours(*f.face, part.edges, std::span(f.mesh->nodes).subspan(f.node_begin, f.node_end - f.node_begin));
  for (const OpenEdge& e : open) {
    const Triangle& t = f.mesh->triangles[e.triangle];
    const auto corner = static_cast<std::size_t>(e.corner);
    const auto [a, b] = std::minmax({t[corner] - f.node_begin, t[(corner + 1) % 3] - f.node_begin});
    found.is_free.push_back(free.count({a, b}) != 0);
  }
}

// Takes the findings of faces together, in their order.
class Report {
 public:
  Report(const Part& part, const PartMesh& mesh, const MakersNotes* notes, const TopologyOptions& options)
      : part_(part), mesh_(mesh), notes_(notes) {
    ISO_CHECK(mesh.first_node.size() == part.faces.size() + 1 && mesh.first_triangle.size() == part.faces.size() + 1);
    ISO_CHECK(mesh.first_node.back() == mesh.nodes.size() && mesh.first_triangle.back() == mesh.triangles.size());
    report_.nodes = mesh.nodes.size();
    report_.faces = part.faces.size();
    std::vector<PointTriangle> triangles;
    triangles.reserve(mesh.triangles.size());
    for (const auto& [a, b, c] : mesh.triangles) {
      ISO_CHECK(std::max({a, b, c}) < mesh.nodes.size());
      triangles.push_back({mesh.nodes[a].point, mesh.nodes[b].point, mesh.nodes[c].point});
    }
    report_.topology = check_topology(mesh.points, triangles, options, &open_);
    std::sort(open_.begin(), open_.end(),
              [](const OpenEdge& a, const OpenEdge& b) { return std::pair(a.triangle, a.corner) < std::pair(b.triangle, b.corner); });
  }

  MeshReport run() {
    std::vector<FaceFindings> found(part_.faces.size());
    tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t f) {
      const FaceMesh face(part_, mesh_, f);
      check_in_space(face, found[f]);
      check_in_domain(face, notes_ && f < notes_->turned.size() && notes_->turned[f], found[f]);
      if (notes_)
        check_borders(face, *notes_, open_of(f), found[f]);
      else
        check_borders(face, part_, open_of(f), found[f]);
    });
    for (std::size_t f = 0; f < found.size(); ++f) take(f, found[f]);
    name_faces();
    return std::move(report_);
  }

 private:
  std::span<const OpenEdge> open_of(std::size_t f) const {
    const auto at = [&](std::uint32_t triangle) {
      return std::lower_bound(open_.begin(), open_.end(), triangle, [](const OpenEdge& e, std::uint32_t t) { return e.triangle < t; });
    };
    return {at(mesh_.first_triangle[f]), at(mesh_.first_triangle[f + 1])};
  }

  MeshPlace place(std::size_t face, std::uint32_t t) const {
    const Triangle& triangle = mesh_.triangles[t];
    const Point3 sum = mesh_.corner(triangle, 0) + mesh_.corner(triangle, 1) + mesh_.corner(triangle, 2);
    return {sum / 3.0, t, static_cast<int>(face)};
  }

  void take(std::size_t f, const FaceFindings& found) {
    for (const std::uint32_t t : found.folded) report_.folded.add(place(f, t));
    for (const std::uint32_t t : found.turned) report_.turned.add(place(f, t));
    for (const std::uint32_t t : found.overlapping) report_.overlapping.add(place(f, t));
    const std::span<const OpenEdge> open = open_of(f);
    for (std::size_t i = 0; i < open.size(); ++i) {
      const Triangle& t = mesh_.triangles[open[i].triangle];
      const Point3 middle = 0.5 * (mesh_.corner(t, open[i].corner) + mesh_.corner(t, (open[i].corner + 1) % 3));
      (found.is_free[i] ? report_.free_edges : report_.cracks).add({middle, open[i].triangle, static_cast<int>(f)});
    }
    const bool is_copy = notes_ && f < notes_->copies.size() && notes_->copies[f];
    if (found.shapes.triangles == 0 && !is_copy) report_.empty_faces.add({Point3(0.0), -1, static_cast<int>(f)});
    report_.shapes.triangles += found.shapes.triangles;
    report_.shapes.slivers += found.shapes.slivers;
    report_.shapes.smallest_angle = std::min(report_.shapes.smallest_angle, found.shapes.smallest_angle);
    report_.shapes_of_face.push_back(found.shapes);
  }

  // The topology knows triangles only.
  void name_faces() {
    TopologyReport& t = report_.topology;
    for (Finding* finding :
         {&t.open_edges, &t.non_manifold_edges, &t.misoriented_edges, &t.non_manifold_points, &t.zero_area, &t.duplicates, &t.t_junctions})
      for (MeshPlace& at : finding->places) {
        const auto after = std::upper_bound(mesh_.first_triangle.begin(), mesh_.first_triangle.end(), at.triangle);
        at.face = static_cast<int>(after - mesh_.first_triangle.begin()) - 1;
      }
  }

  const Part& part_;
  const PartMesh& mesh_;
  const MakersNotes* notes_;
  std::vector<OpenEdge> open_;
  MeshReport report_;
};

double angle(const Vec3& a, const Vec3& b) { return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * (180 / kPi); }

}  // namespace

void add_shape(TriangleShapes& shapes, const Point3& a, const Point3& b, const Point3& c) {
  ++shapes.triangles;
  if (has_no_area(a, b, c)) return;
  const double least = std::min({angle(b - a, c - a), angle(c - b, a - b), angle(a - c, b - c)});
  shapes.smallest_angle = std::min(shapes.smallest_angle, least);
  shapes.slivers += least < kSliver;
}

bool MeshReport::sound() const {
  for (const Finding* f : {&cracks, &folded, &turned, &overlapping, &empty_faces})
    if (f->count != 0) return false;
  return topology.sound();
}

MeshReport verify(const Part& part, const PartMesh& mesh, const TopologyOptions& options) {
  return Report(part, mesh, nullptr, options).run();
}

MeshReport verify(const Part& part, const PartMesh& mesh, const MakersNotes& notes, const TopologyOptions& options) {
  return Report(part, mesh, &notes, options).run();
}

}  // namespace iso
