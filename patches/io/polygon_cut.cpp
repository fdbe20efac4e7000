// Polygons of mesh files are cut into triangles ear by ear.
#include <fmt/format.h>

#include <queue>
#include <span>
#include <tuple>

#include "patches/io/mesh_input.h"

namespace iso {
namespace {

// A corner whose sides turn by less (sine of the angle) is taken for straight: ten times what float coordinates leave of a straight angle
// between sides of about the polygon's size.
constexpr double kStraightSine = 1e-6;

// Ears that stay hidden until others are cut appear when all corners are looked at again; polygons that cross themselves would ask for that
// at every corner.
constexpr int kMostReviews = 4;

double cross(const Vec2& a, const Vec2& b) { return a.x * b.y - a.y * b.x; }

class PolygonCutter {
 public:
  PolygonCutter(const std::vector<Point3>& points, std::vector<PointTriangle>& triangles) : points_(points), triangles_(triangles) {}

  void cut(std::span<const std::uint32_t> polygon) {
    gather(polygon);
    if (corners_.size() < 3) {
      ++without_area;
      return;
    }
    if (corners_.size() > 3) {
      ++polygons_cut;
      triangles_made += corners_.size() - 2;
      flatten();
      cut_ears();
    } else {
      triangles_.push_back({corners_[0], corners_[1], corners_[2]});
    }
  }

  std::uint64_t polygons_cut = 0, triangles_made = 0, without_area = 0, repeated = 0, crossing = 0;

 private:
  enum class Kind { ear, straight, hidden };
  enum class Turn { left, straight, right };

  struct Candidate {
    Kind kind;
    double diagonal;  // squared
    std::uint32_t corner, version;
    auto key() const { return std::tuple(kind, diagonal, corner); }
    bool operator<(const Candidate& other) const { return key() > other.key(); }  // the queue's top is the best
  };

  // The corners without those that repeat the one before; triangles keep theirs.
  void gather(std::span<const std::uint32_t> polygon) {
    corners_.assign(polygon.begin(), polygon.end());
    if (corners_.size() <= 3) return;
    const auto same = [&](std::uint32_t a, std::uint32_t b) { return points_[a] == points_[b]; };
    corners_.erase(std::unique(corners_.begin(), corners_.end(), same), corners_.end());
    while (corners_.size() > 1 && same(corners_.front(), corners_.back())) corners_.pop_back();
    repeated += polygon.size() - corners_.size();
  }

  // Drops the coordinate in which the mean normal [Newell] is largest; then the polygon runs counter-clockwise.
  void flatten() {
    const std::size_t n = corners_.size();
    const Point3 origin = points_[corners_[0]];
    Vec3 normal(0.0), largest(0.0);
    for (std::size_t i = 1; i + 1 < n; ++i) {
      const Vec3 area = glm::cross(points_[corners_[i]] - origin, points_[corners_[i + 1]] - origin);
      normal += area;
      if (glm::dot(area, area) > glm::dot(largest, largest)) largest = area;
    }
    if (glm::length(normal) < kStraightSine * glm::length(largest)) normal = largest;  // a figure of eight has two sides to look at
    int axis = 0;
    for (int c = 1; c < 3; ++c)
      if (std::abs(normal[c]) > std::abs(normal[axis])) axis = c;
    int u = (axis + 1) % 3, v = (axis + 2) % 3;
    if (normal[axis] < 0) std::swap(u, v);
    flat_.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3 p = points_[corners_[i]] - origin;
      flat_[i] = Vec2(p[u], p[v]);
    }
  }

  void cut_ears() {
    start();
    bool crosses = false;
    for (int reviews = 0; left_ > 3;) {
      const Candidate best = queue_.top();
      queue_.pop();
      if (best.version != version_[best.corner]) continue;
      if (best.kind != Kind::ear && reviews < kMostReviews) {
        ++reviews;
        judge_all();
        continue;
      }
      crosses = crosses || best.kind == Kind::hidden;
      cut_off(best.corner);
    }
    const std::uint32_t last = first_left();
    emit(last);
    crossing += crosses || turn(last) == Turn::right;  // as what is left of a figure of eight
  }

  void start() {
    const auto n = static_cast<std::uint32_t>(corners_.size());
    left_ = n;
    previous_.resize(n);
    next_.resize(n);
    version_.assign(n, 0);
    turns_.resize(n);
    for (std::uint32_t i = 0; i < n; ++i) {
      previous_[i] = i == 0 ? n - 1 : i - 1;
      next_[i] = i + 1 == n ? 0 : i + 1;
    }
    judge_all();
  }

  void judge_all() {
    queue_ = {};
    blockers_.clear();
    for (std::uint32_t i = 0; i < corners_.size(); ++i) {
      if (version_[i] == kGone) continue;
      turns_[i] = turn(i);
      if (turns_[i] != Turn::left) blockers_.push_back(i);
    }
    for (std::uint32_t i = 0; i < corners_.size(); ++i)
      if (version_[i] != kGone) judge(i);
  }

  Turn turn(std::uint32_t i) const {
    const Vec2 in = flat_[i] - flat_[previous_[i]], out = flat_[next_[i]] - flat_[i];
    const double sine = cross(in, out), least = kStraightSine * glm::length(in) * glm::length(out);
    return sine > least ? Turn::left : sine >= -least ? Turn::straight : Turn::right;
  }

  // Puts a corner into the queue as it is now.
  void judge(std::uint32_t i) {
    const Turn t = turns_[i] = turn(i);
    const Kind kind = t == Turn::straight ? Kind::straight : t == Turn::left && !is_blocked(i) ? Kind::ear : Kind::hidden;
    const Vec3 diagonal = points_[corners_[next_[i]]] - points_[corners_[previous_[i]]];
    queue_.push({kind, glm::dot(diagonal, diagonal), i, ++version_[i]});
  }

  // Whether another corner lies in the ear's triangle or on its border; on the diagonal counts as far as straight does. Only corners that
  // do not turn left need asking. Those at a corner of the triangle are ends of bridges.
  bool is_blocked(std::uint32_t i) {
    const std::uint32_t before = previous_[i], after = next_[i];
    const Vec2 a = flat_[before], b = flat_[i], c = flat_[after];
    for (std::size_t k = 0; k < blockers_.size();) {
      const std::uint32_t w = blockers_[k];
      if (version_[w] == kGone || turns_[w] == Turn::left) {
        blockers_[k] = blockers_.back();
        blockers_.pop_back();
        continue;
      }
      ++k;
      const Vec2 p = flat_[w];
      if (w == before || w == i || w == after || p == a || p == b || p == c) continue;
      if (cross(b - a, p - a) < 0 || cross(c - b, p - b) < 0) continue;
      if (cross(a - c, p - c) >= -kStraightSine * glm::length(a - c) * glm::length(p - c)) return true;
    }
    return false;
  }

  void cut_off(std::uint32_t i) {
    emit(i);
    const std::uint32_t before = previous_[i], after = next_[i];
    next_[before] = after;
    previous_[after] = before;
    version_[i] = kGone;
    --left_;
    for (const std::uint32_t neighbour : {before, after})
      if (left_ > 3) judge(neighbour);
  }

  std::uint32_t first_left() const {
    std::uint32_t i = 0;
    while (version_[i] == kGone) ++i;
    return next_[i];  // so that the triangle starts with the corner that comes first in the file
  }

  void emit(std::uint32_t i) { triangles_.push_back({corners_[previous_[i]], corners_[i], corners_[next_[i]]}); }

  static constexpr std::uint32_t kGone = 0xFFFFFFFF;
  const std::vector<Point3>& points_;
  std::vector<PointTriangle>& triangles_;
  std::vector<std::uint32_t> corners_, previous_, next_, version_, blockers_;
  std::vector<Turn> turns_;
  std::vector<Vec2> flat_;
  std::priority_queue<Candidate> queue_;
  std::uint32_t left_ = 0;
};

}  // namespace

void cut_polygons(const Polygons& polygons, ForeignMesh& mesh) {
  mesh.triangles.reserve(mesh.triangles.size() + polygons.ends.size());
  PolygonCutter cutter(mesh.points, mesh.triangles);
  std::uint64_t begin = 0;
  for (const std::uint64_t end : polygons.ends) {
    cutter.cut(std::span(polygons.corners).subspan(begin, end - begin));
    begin = end;
  }

  const auto note = [&](std::uint64_t count, const std::string& text) {
    if (count > 0) mesh.notes.push_back(text);
  };
  note(cutter.polygons_cut,
       fmt::format("polygons of more than three corners: {}, cut into {} triangles", cutter.polygons_cut, cutter.triangles_made));
  note(cutter.repeated, fmt::format("corners of polygons that repeat the one before, left out: {}", cutter.repeated));
  note(cutter.without_area, fmt::format("polygons of fewer than three corners, left out: {}", cutter.without_area));
  note(cutter.crossing, fmt::format("polygons that cross or touch themselves and have no clear inside: {}", cutter.crossing));
}

}  // namespace iso
