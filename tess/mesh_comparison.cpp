#include "tess/mesh_comparison.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>

#include "tess/comparison_sources.h"
#include "tess/mesh_faults.h"
#include "tess/one_sided.h"

namespace iso {
namespace {

// How fine our own mesh is made, where nobody says: first this share of the diagonal; then this share of the mesh's own distance, but not
// finer than so many triangles allow.
constexpr double kFirstReference = 1e-4, kShareOfDistance = 0.02, kFinestReference = 1e-8;
constexpr double kMostReferenceTriangles = 1.5e6, kFinerAtOnce = 16;

// A tolerance for which splines beside charts must be one level finer, not more: those take much memory, and the finest may not do.
constexpr double kOneSplineFiner = 4;

constexpr double kSpacing = 1.0 / 96;  // of the diagonal, between samples
constexpr double kUsual = 0.95;        // the share of triangles whose distances are taken for usual
constexpr double kWellBeyond = 4;      // times the usual
constexpr double kNothing = 1e-9;      // of the diagonal: distances that no use of a mesh can tell from none
constexpr double kFlatArc = 0.3;       // of its length: an edge is at most this far from the arc between its ends that it stands for

double angle_between(const Vec3& a, const Vec3& b) { return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)); }

class Comparison {
 public:
  Comparison(std::span<const PlacedPart> parts, const ForeignMesh& mesh, const ComparisonSettings& settings,
             const std::function<void(double)>& progress)
      : parts_(parts), mesh_(mesh), settings_(settings), progress_(progress) {}

  MeshComparison run() {
    const auto begin = std::chrono::steady_clock::now();
    choose_reference();
    result_.reference_bound = faces_->bound();
    result_.model_gap = faces_->gap();
    result_.reference_triangles = faces_->triangles().size();
    start_faces();
    find_points_and_triangles();
    measure_both_ways();
    finish_faces();
    check_topology_and_gaps();
    name_faults();
    result_.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return std::move(result_);
  }

 private:
  void choose_reference();
  double rough_distance() const;
  void start_faces();
  void find_points_and_triangles();
  TriangleFinding look_at(std::size_t t) const;
  void measure_both_ways();
  double usual_distance(const std::vector<float>& worst_of_triangle);
  double least_distance() const;
  void finish_faces();
  void check_topology_and_gaps();
  void name_faults();
  template <class F>
  void in_parallel(std::size_t n, double share, F f);

  std::span<const PlacedPart> parts_;
  const ForeignMesh& mesh_;
  const ComparisonSettings& settings_;
  const std::function<void(double)>& progress_;
  double done_ = 0;

  std::unique_ptr<ExactFaces> faces_;
  std::unique_ptr<TriangleTree> tree_;
  double diagonal_ = 0;
  std::vector<PointFinding> points_;
  std::vector<TriangleFinding> triangles_;
  std::vector<OpenEdge> cracks_;
  std::vector<float> nearest_of_triangle_;
  std::vector<double> missing_;
  double usual_middle_ = 0, usual_point_ = 0, far_ = 0, far_point_ = 0;
  MeshComparison result_;
};

// f(i) for all i < n in chunks; the progress moves on by `share`.
template <class F>
void Comparison::in_parallel(std::size_t n, double share, F f) {
  constexpr std::size_t kChunk = 2048;
  std::atomic<std::size_t> done{0};
  std::mutex telling;
  tbb::parallel_for(std::size_t{0}, (n + kChunk - 1) / kChunk, [&](std::size_t c) {
    const std::size_t end = std::min(n, (c + 1) * kChunk);
    for (std::size_t i = c * kChunk; i < end; ++i) f(i);
    const std::size_t now = done += end - c * kChunk;
    const std::scoped_lock lock(telling);
    progress_(done_ + share * static_cast<double>(now) / static_cast<double>(n));
  });
  done_ += share;
}

// The largest distance of some points of the mesh: of all if it has few.
double Comparison::rough_distance() const {
  constexpr std::size_t kMost = 20000;
  const std::size_t step = std::max<std::size_t>(1, mesh_.triangles.size() / kMost);
  std::vector<double> far((mesh_.triangles.size() + step - 1) / step);
  tbb::parallel_for(std::size_t{0}, far.size(), [&](std::size_t i) {
    const auto& [a, b, c] = mesh_.triangles[i * step];
    far[i] = faces_->nearest((mesh_.points[a] + mesh_.points[b] + mesh_.points[c]) / 3.0).distance;
  });
  const auto usual = far.begin() + static_cast<std::ptrdiff_t>(kUsual * static_cast<double>(far.size() - 1));
  std::nth_element(far.begin(), usual, far.end());
  return *usual;
}

void Comparison::choose_reference() {
  // In the coordinates of the first part, so that it does not depend on how all of them are turned.
  Box3 box;
  const Affine3 to_first = inverse(parts_[0].to_world);
  for (const PlacedPart& p : parts_) box.include(transformed(to_first * p.to_world, p.part->box));
  diagonal_ = stretch_of(parts_[0].to_world) * box.diagonal();
  if (settings_.reference > 0) {
    faces_ = std::make_unique<ExactFaces>(parts_, settings_.reference);
    usual_middle_ = rough_distance();
    return;
  }
  double now = kFirstReference * diagonal_;
  faces_ = std::make_unique<ExactFaces>(parts_, now);
  usual_middle_ = rough_distance();
  double splines = 0;  // how far the charts of n-sided patches are from theirs
  for (const PlacedPart& p : parts_)
    for (const Face& face : p.part->faces) splines = std::max(splines, stretch_of(p.to_world) * distance_of_pieces(face.surface));
  const double wanted = std::max({kShareOfDistance * usual_middle_, kFinestReference * diagonal_, kOneSplineFiner * splines});
  // Triangles grow as one over the distance, once they are many: what few of them promise may be wrong by far (flat faces whose parameters
  // bend), so that the way there is not taken at once.
  for (;;) {
    const double affordable = now * static_cast<double>(faces_->triangles().size()) / kMostReferenceTriangles;
    const double next = std::max({wanted, affordable, now / kFinerAtOnce});
    if (!(next < 0.7 * now)) return;
    faces_ = std::make_unique<ExactFaces>(parts_, next);
    now = next;
  }
}

void Comparison::start_faces() {
  for (const ExactFaces::Known& known : faces_->faces()) {
    FaceComparison face;
    face.placed = known.placed;
    face.face = known.face;
    face.area = known.area;
    result_.unmeasured_faces += known.first == known.end;
    result_.faces.push_back(face);
  }
  result_.all.area = 0;
}

void Comparison::find_points_and_triangles() {
  points_.resize(mesh_.points.size());
  in_parallel(points_.size(), 0.1, [&](std::size_t i) {
    const std::uint32_t hint = i % 2048 ? points_[i - 1].reference : TriangleTree::kNone;
    const ExactFaces::Foot foot = faces_->nearest(mesh_.points[i], hint);
    points_[i] = {foot.distance, foot.triangle, foot.normal};
  });
  triangles_.resize(mesh_.triangles.size());
  in_parallel(triangles_.size(), 0.1, [&](std::size_t t) { triangles_[t] = look_at(t); });
}

TriangleFinding Comparison::look_at(std::size_t t) const {
  const PointTriangle& corners = mesh_.triangles[t];
  const Point3 &a = mesh_.points[corners[0]], &b = mesh_.points[corners[1]], &c = mesh_.points[corners[2]];
  const ExactFaces::Foot foot = faces_->nearest((a + b + c) / 3.0, points_[corners[0]].reference);
  const Vec3 n = glm::cross(b - a, c - a);
  TriangleFinding found;
  found.face = faces_->face_of(foot.triangle);
  found.distance = foot.distance;
  found.reference = foot.triangle;
  found.area = static_cast<float>(0.5 * glm::length(n));
  if (has_no_area(a, b, c)) return found;
  double angle = foot.normal == Vec3(0.0) ? 0.0 : angle_between(n, foot.normal);
  if (angle > kPi / 2) {
    // At sharp edges and in walls thinner than what is usual for the mesh it may stand for another sheet: what is turned contradicts all.
    const Point3 middle = (a + b + c) / 3.0;
    const double reach = std::max(foot.distance, usual_middle_) + 2 * faces_->bound();
    faces_->tree().for_each_touching(Box3{middle, middle}.inflated(reach), [&](std::uint32_t i) {
      const TriangleTree::Nearest near = faces_->tree().on(i, middle);
      if (near.distance > reach) return;
      const double other = angle_between(n, faces_->lifted(i, near.weights).normal);
      // A neighbour over a sharp edge is no such sheet.
      if (near.distance > foot.distance + 2 * faces_->bound() && other > kPi / 3) return;
      if (other < angle) angle = other, found.face = faces_->face_of(i);
    });
  }
  found.inward = angle > kPi / 2;
  // Near the corners, where the surface bends away: over the triangle, not at them, where creases, poles and other faces begin.
  for (int k = 0; k < 3 && !found.inward; ++k) {
    constexpr double kNear = 0.9;
    Vec3 l((1 - kNear) / 2);
    l[k] = kNear;
    const ExactFaces::Foot near = faces_->nearest(l.x * a + l.y * b + l.z * c, found.reference);
    if (faces_->face_of(near.triangle) != found.face || near.normal == Vec3(0.0)) continue;
    // A foot of another sheet of the same face says nothing of this one.
    if (const double other = angle_between(n, near.normal); other <= kPi / 2) angle = std::max(angle, other);
  }
  found.angle = static_cast<float>(angle);
  return found;
}

void Comparison::measure_both_ways() {
  const std::size_t groups = result_.faces.size();
  const double spacing = kSpacing * diagonal_;
  std::atomic<std::size_t> done{0};
  std::mutex telling;
  const double n = static_cast<double>(mesh_.triangles.size() + faces_->triangles().size());
  const auto step = [&](std::size_t more) {
    const std::size_t now = done += more;
    const std::scoped_lock lock(telling);
    progress_(done_ + 0.75 * static_cast<double>(now) / (2 * n));
  };
  double usual = 0;
  {
    const MeshSource source(*faces_, mesh_, triangles_, points_);
    OneSidedMeter meter(source, groups, spacing);
    const std::vector<OneSided> found = meter.measured(step);
    for (std::size_t f = 0; f < groups; ++f) result_.faces[f].to_surface = found[f];
    result_.all.to_surface = found.back();
    nearest_of_triangle_ = meter.nearest_of_triangle();
    usual = usual_distance(meter.worst_of_triangle());
  }
  tree_ = std::make_unique<TriangleTree>(mesh_.points, mesh_.triangles);
  const SurfaceSource source(*faces_, *tree_, mesh_);
  OneSidedMeter meter(source, groups, spacing);
  const std::vector<OneSided> found = meter.measured(step);
  for (std::size_t f = 0; f < groups; ++f) result_.faces[f].to_mesh = found[f];
  result_.all.to_mesh = found.back();
  done_ += 0.75;

  // What is well beyond the usual of this mesh is a fault of its own. What is usual is asked of the mesh: of the faces some may have none.
  far_ = kWellBeyond * std::max(usual, least_distance());
  for (std::size_t f = 0; f < groups; ++f) missing_.push_back(meter.share_beyond(f, far_));
  far_point_ = std::max(far_, kWellBeyond * usual_point_);
}

// Of the triangles; those with a point far beyond the others do not count, which may be many in a small mesh.
double Comparison::usual_distance(const std::vector<float>& worst_of_triangle) {
  const auto usual_of = [](std::vector<double>& all) {
    const auto at = all.begin() + static_cast<std::ptrdiff_t>(kUsual * static_cast<double>(all.size() - 1));
    std::nth_element(all.begin(), at, all.end());
    return *at;
  };
  std::vector<double> distances;
  for (const PointFinding& p : points_) distances.push_back(p.distance);
  usual_point_ = usual_of(distances);
  const double beyond = kWellBeyond * std::max(usual_point_, least_distance());
  std::vector<double> of_triangles, others;
  for (std::size_t t = 0; t < worst_of_triangle.size(); ++t) {
    const auto is_far = [&](std::uint32_t p) { return points_[p].distance > beyond; };
    (std::ranges::any_of(mesh_.triangles[t], is_far) ? others : of_triangles).push_back(double(worst_of_triangle[t]));
  }
  return usual_of(of_triangles.empty() ? others : of_triangles);
}

double Comparison::least_distance() const { return std::max({faces_->bound(), faces_->gap(), 2 * mesh_.rounding, kNothing * diagonal_}); }

void Comparison::finish_faces() {
  std::vector<double> angles(result_.faces.size(), 0);
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    const TriangleFinding& found = triangles_[t];
    FaceComparison& face = result_.faces[found.face];
    const double area = double(found.area), angle = double(found.angle);
    ++face.triangles;
    face.covered += area;
    if (found.inward) face.inward += area;
    angles[found.face] += area * angle;
    const auto& [a, b, c] = mesh_.triangles[t];
    if (angle > face.worst_angle) {
      face.worst_angle = angle;
      face.worst_angle_at = (mesh_.points[a] + mesh_.points[b] + mesh_.points[c]) / 3.0;
    }
    add_shape(face.shapes, mesh_.points[a], mesh_.points[b], mesh_.points[c]);
  }
  FaceComparison& all = result_.all;
  double all_angles = 0;
  for (std::size_t f = 0; f < result_.faces.size(); ++f) {
    FaceComparison& face = result_.faces[f];
    face.mean_angle = face.covered > 0 ? angles[f] / face.covered : 0;
    all_angles += angles[f];
    all.triangles += face.triangles;
    all.area += face.area;
    all.covered += face.covered;
    all.inward += face.inward;
    all.shapes.triangles += face.shapes.triangles;
    all.shapes.slivers += face.shapes.slivers;
    all.shapes.smallest_angle = std::min(all.shapes.smallest_angle, face.shapes.smallest_angle);
    const auto n = static_cast<int>(f);
    if (face.worst_angle > all.worst_angle) {
      all.worst_angle = face.worst_angle;
      all.worst_angle_at = face.worst_angle_at;
      result_.worst_angle_face = n;
    }
    if (result_.worst_face < 0 || face.worst() > result_.faces[static_cast<std::size_t>(result_.worst_face)].worst())
      result_.worst_face = n;
  }
  all.mean_angle = all.covered > 0 ? all_angles / all.covered : 0;
}

void Comparison::check_topology_and_gaps() {
  std::vector<OpenEdge> open;
  result_.topology = check_topology(mesh_.points, mesh_.triangles, {}, &open);
  // An open edge along a free edge of the model is no defect.
  const TriangleTree ends(faces_->points(), faces_->free_sides());
  for (const OpenEdge& edge : open) {
    const PointTriangle& t = mesh_.triangles[edge.triangle];
    const auto k = static_cast<std::size_t>(edge.corner);
    const Point3 &a = mesh_.points[t[k]], &b = mesh_.points[t[(k + 1) % 3]];
    const bool is_free = !faces_->free_sides().empty() && ends.nearest(a).distance <= far_ && ends.nearest(b).distance <= far_ &&
                         ends.nearest(0.5 * (a + b)).distance <= std::max(far_, kFlatArc * glm::length(b - a));
    ++result_.faces[triangles_[edge.triangle].face].open_edges;
    if (is_free)
      ++result_.free_edges;
    else
      cracks_.push_back(edge);
  }
  result_.all.open_edges = open.size();
  // How wide the cracks are: the distance of each one's middle from the next one that is not its continuation.
  std::vector<PointTriangle> sides;
  for (const OpenEdge& edge : cracks_) {
    const PointTriangle& t = mesh_.triangles[edge.triangle];
    const auto k = static_cast<std::size_t>(edge.corner);
    sides.push_back({t[k], t[(k + 1) % 3], t[(k + 1) % 3]});
  }
  const TriangleTree cracks(mesh_.points, sides);
  std::vector<double> widths(sides.size(), 0);
  tbb::parallel_for(std::size_t{0}, sides.size(), [&](std::size_t i) {
    const auto [a, b, b2] = sides[i];
    const auto apart = [&, a = a, b = b](std::uint32_t other) {
      constexpr double kSharp = 0.25;  // the cosine of the angle at a common point, from which the other one lies opposite
      const PointTriangle& s = sides[other];
      for (const auto& [common, end] : {std::pair(a, b), std::pair(b, a)})
        for (std::size_t k = 0; k < 2; ++k) {
          if (s[k] != common) continue;
          const Vec3 along = mesh_.points[end] - mesh_.points[common], aside = mesh_.points[s[1 - k]] - mesh_.points[common];
          if (!(glm::dot(along, aside) > kSharp * glm::length(along) * glm::length(aside))) return false;
        }
      return other != i;
    };
    widths[i] = cracks.nearest_where(0.5 * (mesh_.points[a] + mesh_.points[b]), TriangleTree::kNone, apart).distance;
  });
  for (double width : widths)
    if (std::isfinite(width)) result_.widest_gap = std::max(result_.widest_gap, width);
}

void Comparison::name_faults() {
  Box3 model, mesh;
  for (const Point3& p : faces_->points()) model.include(p);
  for (const Point3& p : mesh_.points) mesh.include(p);
  result_.faults = faults_of_place(model, mesh, settings_.unit);
  // A mesh that stands elsewhere has no other faults that could be told.
  if (result_.faults.empty())
    result_.faults = faults_of_mesh(
        {*faces_, mesh_, settings_, triangles_, points_, nearest_of_triangle_, cracks_, std::move(missing_), far_, far_point_}, result_);
  progress_(1.0);
}

}  // namespace

MeshComparison compare_mesh(std::span<const PlacedPart> parts, const ForeignMesh& mesh, const ComparisonSettings& settings,
                            const std::function<void(double)>& progress) {
  ISO_CHECK(!parts.empty() && !mesh.triangles.empty());
  return Comparison(parts, mesh, settings, progress).run();
}

}  // namespace iso
