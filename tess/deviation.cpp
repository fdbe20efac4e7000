#include "tess/deviation.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>

#include "patches/trim.h"
#include "tess/box_tree.h"
#include "tess/triangle_distance.h"

namespace iso {

namespace {

constexpr double kBinRatio = 1.01;
constexpr int kBins = 6000;  // from 1e-22 to 1e4 of any unit: below and above count in the first and the last

double bin_log(double distance) { return std::log(distance) / std::log(kBinRatio); }
constexpr double kFirstBin = -5100;  // log of 1e-22 in bins

// The triangles around every point of the mesh.
class Around {
 public:
  explicit Around(const PartMesh& mesh) : first_(mesh.points.size() + 1, 0), triangles_(3 * mesh.triangles.size()) {
    for (const Triangle& t : mesh.triangles)
      for (std::uint32_t n : t) ++first_[mesh.nodes[n].point + 1];
    for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i)
      for (std::uint32_t n : mesh.triangles[i]) triangles_[next[mesh.nodes[n].point]++] = i;
  }
  std::pair<const std::uint32_t*, const std::uint32_t*> of(std::uint32_t point) const {
    return {triangles_.data() + first_[point], triangles_.data() + first_[point + 1]};
  }

 private:
  std::vector<std::uint32_t> first_, triangles_;
};

// All triangles by place, made when first needed: for points from which the way downhill may end in the wrong valley.
class Everywhere {
 public:
  explicit Everywhere(const PartMesh& mesh) : mesh_(mesh) {}

  // The distance of p from the nearest triangle, given one that is not the least.
  double nearest(const Point3& p, double found);

 private:
  const PartMesh& mesh_;
  std::once_flag once_;
  std::optional<BoxTree<Vec3>> tree_;
};

double Everywhere::nearest(const Point3& p, double found) {
  std::call_once(once_, [this] {
    std::vector<Box3> boxes;
    boxes.reserve(mesh_.triangles.size());
    for (const Triangle& t : mesh_.triangles) {
      Box3 box;
      for (int k = 0; k < 3; ++k) box.include(mesh_.corner(t, k));
      boxes.push_back(box);
    }
    tree_.emplace(std::move(boxes));
  });
  tree_->for_each_touching(Box3{p, p}.inflated(found), [&](std::uint32_t i) {
    const Triangle& t = mesh_.triangles[i];
    const Point3 &a = mesh_.corner(t, 0), &b = mesh_.corner(t, 1), &c = mesh_.corner(t, 2);
    const Vec3 l = nearest_in_triangle(p, a, b, c);
    found = std::min(found, glm::length(l.x * a + l.y * b + l.z * c - p));
  });
  return found;
}

// Distance of p from the mesh, found by walking downhill from a triangle over its neighbours.
double distance_to_mesh(const PartMesh& mesh, const Around& around, const Point3& p, std::uint32_t triangle) {
  const auto to = [&](std::uint32_t i, Vec3& l) {
    const Triangle& t = mesh.triangles[i];
    const Point3 &a = mesh.corner(t, 0), &b = mesh.corner(t, 1), &c = mesh.corner(t, 2);
    l = nearest_in_triangle(p, a, b, c);
    return glm::length(l.x * a + l.y * b + l.z * c - p);
  };
  Vec3 l;
  double least = to(triangle, l);
  constexpr int kMostSteps = 16;
  for (int step = 0; step < kMostSteps; ++step) {
    if (l.x > 0 && l.y > 0 && l.z > 0) break;  // inside: nothing beside is nearer
    std::uint32_t best = triangle;
    Vec3 best_l = l;
    const Triangle t = mesh.triangles[triangle];
    for (int k = 0; k < 3; ++k) {
      if (l[k] == 0) continue;  // the nearest point does not touch this corner
      const auto [begin, end] = around.of(mesh.nodes[t[static_cast<std::size_t>(k)]].point);
      for (const std::uint32_t* it = begin; it != end; ++it) {
        Vec3 other;
        if (const double d = to(*it, other); d < least) least = d, best = *it, best_l = other;
      }
    }
    if (best == triangle) break;
    triangle = best;
    l = best_l;
  }
  return least;
}

// Distance of x from the surface near (u, v), by Gauss-Newton steps that are taken only downhill, until one leaves more than `settled` of
// it.
double distance_to_surface(const AnySurface& surface, const Point3& x, UV uv, int steps, double settled) {
  Jet2 at = jet2(surface, uv);
  double least = glm::length(at.S - x);
  for (int i = 0; i < steps; ++i) {
    const Vec3 r = x - at.S;
    const double E = glm::dot(at.Su, at.Su), F = glm::dot(at.Su, at.Sv), G = glm::dot(at.Sv, at.Sv), det = E * G - F * F;
    if (!(det > 1e-12 * E * G)) break;
    const double bu = glm::dot(at.Su, r), bv = glm::dot(at.Sv, r);
    const UV next = uv + UV((G * bu - F * bv) / det, (E * bv - F * bu) / det);
    const Jet2 moved = jet2(surface, next);
    const double d = glm::length(moved.S - x);
    if (!(d < least)) break;
    const bool done = d > settled * least;
    least = d;
    at = moved;
    uv = next;
    if (done) break;
  }
  return least;
}

const std::vector<Vec3>& samples_of(Sampling sampling) {
  static const std::vector<Vec3> quick{{1 / 3.0, 1 / 3.0, 1 / 3.0}, {0.5, 0.5, 0}, {0, 0.5, 0.5}, {0.5, 0, 0.5}};
  static const std::vector<Vec3> fine = [] {
    std::vector<Vec3> all = quick;
    constexpr int kParts = 6;
    for (int i = 0; i <= kParts; ++i)
      for (int j = 0; i + j <= kParts; ++j)
        if (i < kParts && j < kParts && i + j > 0) all.push_back(Vec3(i, j, kParts - i - j) / double(kParts));
    return all;
  }();
  return sampling == Sampling::quick ? quick : fine;
}

class FaceMeter {
 public:
  FaceMeter(const Part& part, const PartMesh& mesh, const Around& around, Everywhere& everywhere, std::size_t face)
      : part_(part), face_(part.faces[face]), mesh_(mesh), around_(around), everywhere_(everywhere) {}

  FaceDeviation measured(std::uint32_t begin, std::uint32_t end, Sampling sampling) {
    double angles = 0;
    std::uint64_t count = 0;
    for (std::uint32_t i = begin; i < end; ++i) {
      const Triangle& t = mesh_.triangles[i];
      const Vec3 cross = glm::cross(mesh_.corner(t, 1) - mesh_.corner(t, 0), mesh_.corner(t, 2) - mesh_.corner(t, 0));
      for (const Vec3& l : samples_of(sampling)) {
        const UV uv = l.x * mesh_.nodes[t[0]].uv + l.y * mesh_.nodes[t[1]].uv + l.z * mesh_.nodes[t[2]].uv;
        const Point3 x = l.x * mesh_.corner(t, 0) + l.y * mesh_.corner(t, 1) + l.z * mesh_.corner(t, 2);
        const Jet2 at = jet2(face_.surface, uv);
        take(result_.to_surface, off_surface(x, uv, t), uv, x);
        if (const double off = off_mesh(at.S, i); !(off > result_.worst) || is_on_face(uv)) take(result_.to_mesh, off, uv, at.S);
        const Vec3 n = glm::cross(at.Su, at.Sv) * (face_.reversed ? -1.0 : 1.0);
        if (glm::length(n) == 0) continue;
        const double angle = std::atan2(glm::length(glm::cross(n, cross)), glm::dot(n, cross));
        result_.worst_angle = std::max(result_.worst_angle, angle);
        angles += angle;
        ++count;
      }
    }
    result_.mean_angle = count ? angles / static_cast<double>(count) : 0;
    return std::move(result_);
  }

 private:
  // What would be the largest distance so far is looked at twice.
  double off_mesh(const Point3& S, std::uint32_t triangle) {
    const double found = distance_to_mesh(mesh_, around_, S, triangle);
    return found > result_.worst ? everywhere_.nearest(S, found) : found;
  }

  // Beside a curved border a triangle reaches beyond the face in (u, v): what lies there is no part of what is meshed.
  bool is_on_face(const UV& uv) {
    if (!region_) region_.emplace(face_, part_.edges, 4 * kEps * part_.box.diagonal());
    return region_->contains(uv, face_.surface).inside;
  }

  double off_surface(const Point3& x, const UV& uv, const Triangle& t) {
    constexpr int kFew = 4, kMany = 32;
    constexpr double kRoughly = 0.999, kAllButRounding = 1 - 1e-13;
    double found = distance_to_surface(face_.surface, x, uv, kFew, kRoughly);
    if (!(found > result_.worst)) return found;
    for (std::uint32_t n : t)
      found = std::min(found, distance_to_surface(face_.surface, x, 0.9 * mesh_.nodes[n].uv + 0.1 * uv, kMany, kAllButRounding));
    return found;
  }

  void take(DistanceCounts& counts, double distance, const UV& uv, const Point3& place) {
    counts.add(distance);
    if (distance <= result_.worst) return;
    result_.worst = distance;
    result_.worst_uv = uv;
    result_.worst_place = place;
  }

  const Part& part_;
  const Face& face_;
  const PartMesh& mesh_;
  const Around& around_;
  Everywhere& everywhere_;
  std::optional<TrimRegion> region_;  // made when first asked
  FaceDeviation result_;
};

}  // namespace

void DistanceCounts::add(double distance) {
  if (bins_.empty()) bins_.assign(kBins, 0);
  const double bin = distance > 0 ? std::clamp(bin_log(distance) - kFirstBin, 0.0, kBins - 1.0) : 0.0;
  ++bins_[static_cast<std::size_t>(bin)];
  ++count_;
  max_ = std::max(max_, distance);
  sum_ += distance;
  sum2_ += distance * distance;
}

void DistanceCounts::add(const DistanceCounts& other) {
  if (other.bins_.empty()) return;
  if (bins_.empty()) bins_.assign(kBins, 0);
  for (std::size_t i = 0; i < bins_.size(); ++i) bins_[i] += other.bins_[i];
  count_ += other.count_;
  max_ = std::max(max_, other.max_);
  sum_ += other.sum_;
  sum2_ += other.sum2_;
}

double DistanceCounts::rms() const { return count_ ? std::sqrt(sum2_ / static_cast<double>(count_)) : 0.0; }

double DistanceCounts::percentile(double share) const {
  std::uint64_t below = 0;
  const auto wanted = static_cast<std::uint64_t>(std::ceil(share * static_cast<double>(count_)));
  for (std::size_t i = 0; i < bins_.size(); ++i) {
    below += bins_[i];
    if (below >= wanted && wanted > 0) return i == 0 ? 0.0 : std::min(max_, std::pow(kBinRatio, static_cast<double>(i) + 1 + kFirstBin));
  }
  return max_;
}

Deviation measure(const Part& part, const PartMesh& mesh, Sampling sampling) {
  const Around around(mesh);
  Everywhere everywhere(mesh);
  Deviation result;
  result.faces.resize(part.faces.size());
  tbb::parallel_for(std::size_t{0}, part.faces.size(), [&](std::size_t f) {
    result.faces[f] = FaceMeter(part, mesh, around, everywhere, f).measured(mesh.first_triangle[f], mesh.first_triangle[f + 1], sampling);
  });
  double angles = 0, count = 0;
  for (std::size_t f = 0; f < result.faces.size(); ++f) {
    const FaceDeviation& face = result.faces[f];
    result.all.to_surface.add(face.to_surface);
    result.all.to_mesh.add(face.to_mesh);
    result.all.worst_angle = std::max(result.all.worst_angle, face.worst_angle);
    angles += face.mean_angle * static_cast<double>(face.to_mesh.count());
    count += static_cast<double>(face.to_mesh.count());
    if (face.worst <= result.all.worst) continue;
    result.all.worst = face.worst;
    result.all.worst_uv = face.worst_uv;
    result.all.worst_place = face.worst_place;
    result.worst_face = static_cast<int>(f);
  }
  result.all.mean_angle = count > 0 ? angles / count : 0;
  return result;
}

}  // namespace iso
