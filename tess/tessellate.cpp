#include "tess/tessellate.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <unordered_map>

#include "tess/copied_faces.h"
#include "tess/face_mesh.h"
#include "tess/orient.h"

namespace iso {

namespace {

// Segments of edges may use this share of the tolerance; what is left is for the triangles beside them.
constexpr double kEdgeShare = 0.8;

// A part is meshed to this share of its size at least: coarser meshes of closed faces fall flat.
constexpr double kLargestDistance = 0.1;

// Rounds after which what still touches or crosses is left as it is.
constexpr int kMostRounds = 16;

using Side = std::uint64_t;  // two points
Side side_of(std::uint32_t a, std::uint32_t b) { return (static_cast<Side>(std::min(a, b)) << 32) | std::max(a, b); }

class PartMesher {
 public:
  PartMesher(const Part& part, const TessellationOptions& options)
      : part_(part),
        options_(options),
        copy_of_(options.copies == Copies::MeshOnce ? copied_faces(part) : std::vector<int>(part.faces.size(), -1)),
        boundary_(part, options.sew, copy_of_) {
    std::vector<std::optional<FaceShape>> shapes(part.faces.size());
    tbb::parallel_for(std::size_t{0}, shapes.size(), [&](std::size_t f) { shapes[f].emplace(part.faces[f], options.distance); });
    shapes_.reserve(shapes.size());
    for (auto& shape : shapes) shapes_.push_back(std::move(*shape));
    net_.emplace(
        part, boundary_, shapes_,
        EdgePolicy{kEdgeShare * (options.trim > 0 ? options.trim : options.distance), kEdgeShare * options.distance, options.angle});
    faces_.resize(part.faces.size());
    extra_.resize(part.faces.size());
  }

  PartTessellation run() {
    std::set<int> dirty;
    for (std::size_t f = 0; f < part_.faces.size(); ++f) dirty.insert(static_cast<int>(f));
    part_double_segments();
    int round = 0;
    for (; !dirty.empty() && round < kMostRounds; ++round) {
      mesh_faces({dirty.begin(), dirty.end()});
      dirty = split_wanted();
      if (dirty.empty()) dirty = part_touching();
    }
    // What still asks for finer edges after so many rounds has loops that lie on each other: it is meshed as it is, and says so.
    if (!dirty.empty()) mesh_faces({dirty.begin(), dirty.end()}, true);
    PartTessellation result = assembled();
    result.rounds = round;
    return result;
  }

 private:
  void mesh_faces(const std::vector<int>& which, bool borders_are_final = false) {
    const FacePolicy policy{options_.distance, options_.angle, borders_are_final};
    tbb::parallel_for(std::size_t{0}, which.size(), [&](std::size_t i) {
      const auto f = static_cast<std::size_t>(which[i]);
      faces_[f] = mesh_face(shapes_[f], boundary_.loops[f], boundary_, *net_, policy, extra_[f]);
    });
  }

  // Splits segments (those of an edge from its end, so that indices stay true) and tells the faces that use them.
  std::set<int> split(const std::set<EdgeSegment>& segments) {
    std::set<int> touched;
    for (auto it = segments.rbegin(); it != segments.rend(); ++it) {
      if (!net_->split(it->edge, it->segment)) continue;
      for (int use : boundary_.edges[static_cast<std::size_t>(it->edge)].uses)
        touched.insert(boundary_.uses[static_cast<std::size_t>(use)].face);
    }
    return touched;
  }

  std::set<int> split_wanted() {
    std::set<EdgeSegment> wanted;
    std::set<int> asking;
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      wanted.insert(faces_[f].to_split.begin(), faces_[f].to_split.end());
      if (!faces_[f].to_split.empty()) asking.insert(static_cast<int>(f));
      faces_[f].to_split.clear();
    }
    return split(wanted);
  }

  // Two edges between the same two vertices must not become one segment.
  void part_double_segments() {
    for (int round = 0; round < kMostRounds; ++round) {
      std::map<Side, EdgeSegment> seen;
      std::set<EdgeSegment> doubled;
      for (std::size_t e = 0; e < boundary_.edges.size(); ++e) {
        if (boundary_.edges[e].degenerate) continue;
        const auto& points = net_->edge(static_cast<int>(e)).point;
        for (std::uint32_t i = 0; i + 1 < points.size(); ++i) {
          if (points[i] == points[i + 1]) continue;  // where the edge is a point in space along a part of its length
          const EdgeSegment at{static_cast<int>(e), i};
          const auto [known, is_new] = seen.try_emplace(side_of(points[i], points[i + 1]), at);
          if (is_new) continue;
          doubled.insert(at);
          doubled.insert(known->second);
        }
      }
      if (doubled.empty() || split(doubled).empty()) return;
    }
  }

  // Triangles' sides between two border points that several faces have in common, though they are no segments of edges, would make edges
  // with more than two triangles: each such side takes a point in its middle.
  std::set<int> part_touching() {
    struct Use {
      std::size_t face;
      UV middle;
    };
    std::unordered_map<Side, std::vector<Use>> sides;
    for (std::size_t f = 0; f < faces_.size(); ++f)
      for (const Triangle& t : faces_[f].triangles)
        for (std::size_t k = 0; k < 3; ++k) {
          const std::uint32_t a = t[k], b = t[(k + 1) % 3];
          const FaceMesh& mesh = faces_[f];
          if (!mesh.on_edge(a) || !mesh.on_edge(b)) continue;
          sides[side_of(mesh.nodes[a].point, mesh.nodes[b].point)].push_back({f, 0.5 * (mesh.nodes[a].uv + mesh.nodes[b].uv)});
        }
    std::unordered_map<Side, int> segments;
    for (std::size_t e = 0; e < boundary_.edges.size(); ++e) {
      const auto& points = net_->edge(static_cast<int>(e)).point;
      for (std::size_t i = 0; i + 1 < points.size(); ++i)
        segments[side_of(points[i], points[i + 1])] += static_cast<int>(boundary_.edges[e].uses.size());
    }
    std::set<int> touched;
    for (const auto& [side, uses] : sides) {
      const auto on_edge = segments.find(side);
      const int allowed = on_edge == segments.end() ? 2 : std::max(2, on_edge->second);
      if (static_cast<int>(uses.size()) <= allowed) continue;
      for (const Use& use : uses) {
        auto& extra = extra_[use.face];
        if (std::find(extra.begin(), extra.end(), use.middle) != extra.end()) continue;
        extra.push_back(use.middle);
        touched.insert(static_cast<int>(use.face));
      }
    }
    for (int f : touched)
      std::sort(extra_[static_cast<std::size_t>(f)].begin(), extra_[static_cast<std::size_t>(f)].end(),
                [](const UV& a, const UV& b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
    return touched;
  }

  PartTessellation assembled() {
    PartTessellation result;
    result.unresolved_edges = net_->unresolved();
    result.joins = std::move(boundary_.joins);
    PartMesh& mesh = result.mesh;
    std::vector<std::uint32_t> number(net_->points().size(), 0xffffffffu);  // of the net's points, those that are used
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      FaceMesh& face = faces_[f];
      const auto first = static_cast<std::uint32_t>(mesh.nodes.size());
      for (std::size_t i = 0; i < face.border; ++i) {
        std::uint32_t& n = number[face.nodes[i].point];
        if (n != 0xffffffffu) continue;
        n = static_cast<std::uint32_t>(mesh.points.size());
        mesh.points.push_back(net_->points()[face.nodes[i].point]);
      }
      const auto first_inner = static_cast<std::uint32_t>(mesh.points.size());
      mesh.points.insert(mesh.points.end(), face.inner.begin(), face.inner.end());
      for (MeshNode node : face.nodes) {
        node.point = node.point < FaceMesh::kInner ? number[node.point] : first_inner + (node.point - FaceMesh::kInner);
        mesh.nodes.push_back(node);
      }
      for (const Triangle& t : face.triangles) mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
      mesh.first_node.push_back(static_cast<std::uint32_t>(mesh.nodes.size()));
      mesh.first_triangle.push_back(static_cast<std::uint32_t>(mesh.triangles.size()));
      result.faces.push_back(report_of(face, copy_of_[f]));
      face = {};
    }
    add_free_sides(number, result.free_sides);
    const Orientation orientation = orient(mesh);
    turn(mesh, orientation.turned);
    for (std::size_t f = 0; f < result.faces.size(); ++f) result.faces[f].turned = orientation.turned[f];
    result.one_sided = orientation.conflicts;
    return result;
  }

  void add_free_sides(const std::vector<std::uint32_t>& number, std::vector<std::array<std::uint32_t, 2>>& sides) const {
    for (std::size_t e = 0; e < boundary_.edges.size(); ++e) {
      if (boundary_.edges[e].degenerate || boundary_.edges[e].uses.size() != 1) continue;
      const auto& points = net_->edge(static_cast<int>(e)).point;
      for (std::size_t i = 0; i + 1 < points.size(); ++i) {
        const std::uint32_t a = number[points[i]], b = number[points[i + 1]];
        if (a != b) sides.push_back({std::min(a, b), std::max(a, b)});
      }
    }
    std::sort(sides.begin(), sides.end());
  }

  static FaceReport report_of(const FaceMesh& face, int copy_of) {
    FaceReport report;
    report.copy_of = copy_of;
    if (copy_of >= 0) return report;
    report.bound = face.bound;
    report.offset = face.offset;
    report.triangles = static_cast<int>(face.triangles.size());
    report.unresolved = face.unresolved;
    report.collapsed = face.collapsed;
    report.folded = face.folded;
    report.at_folds = face.at_folds;
    report.fold = face.fold;
    report.crossings = face.crossings;
    if (face.triangles.empty())
      report.failure = face.nodes.size() < 3 ? "its loops have less than three points" : "its loops enclose nothing";
    return report;
  }

  const Part& part_;
  TessellationOptions options_;
  std::vector<int> copy_of_;
  Boundary boundary_;
  std::vector<FaceShape> shapes_;
  std::optional<EdgeNet> net_;
  std::vector<FaceMesh> faces_;
  std::vector<std::vector<UV>> extra_;
};

}  // namespace

MakersNotes notes_of(const PartTessellation& made) {
  MakersNotes notes{made.free_sides, {}, {}};
  for (const FaceReport& face : made.faces) {
    notes.turned.push_back(face.turned);
    notes.copies.push_back(face.copy_of >= 0);
  }
  return notes;
}

PartTessellation tessellate(const Part& part, const TessellationOptions& options) {
  TessellationOptions kept = options;
  const double most = kLargestDistance * part.box.diagonal();
  if (most > 0) kept.distance = std::min(kept.distance, most);
  return PartMesher(part, kept).run();
}

}  // namespace iso
