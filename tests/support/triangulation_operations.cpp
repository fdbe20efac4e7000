#include "tests/support/triangulation_operations.h"

#include <algorithm>
#include <random>

#include "tests/support/triangulation_checks.h"

namespace iso::test {
namespace {

constexpr std::size_t kMostOperations = 160;  // the checks are slow

class Machine {
 public:
  explicit Machine(OperationCounts& counts) : counts_(counts) {}

  std::string step(std::uint8_t what, std::uint8_t x, std::uint8_t y) {
    std::string wrong;
    switch (what % 8) {
      case 0:
      case 1:
      case 2:
        wrong = insert(what, x, y);
        break;
      case 3:
      case 4:
      case 5:
        wrong = constrain(x, y);
        break;
      case 6:
        wrong = mark();
        break;
      default:
        swap_and_restore(x, y);
    }
    if (wrong.empty()) wrong = unsound(all_);
    if (wrong.empty()) wrong = not_constrained(all_, segments_);
    if (wrong.empty()) wrong = not_delaunay(all_, nudged_ ? Delaunay::ButForRounding : Delaunay::Exactly);
    if (wrong.empty() && marked_) wrong = not_marked();
    return wrong;
  }

 private:
  std::string insert(std::uint8_t what, std::uint8_t x, std::uint8_t y) {
    Vec2 p{1 + x % 16, 1 + y % 16};
    // One point in four lies beside the grid by rounding.
    if ((what & 0x18) == 0x18) {
      p.x = std::nextafter(p.x, x & 16 ? 20 : -20);
      p.y = std::nextafter(p.y, y & 16 ? p.y : -20);
      nudged_ = true;
    }
    const bool there = std::find(all_.points().begin(), all_.points().end(), p) != all_.points().end();
    const std::size_t before = all_.points().size();
    const Vertex v = all_.insert(p, what & 0x20 ? Triangulation::kNone : y % static_cast<Vertex>(before));
    if (all_.points()[v] != p) return "insert gave another vertex";
    const bool made = all_.points().size() != before;
    if (made == there || made == all_.changed().empty()) return "a point was lost or is there twice";
    (made ? counts_.inserted : counts_.met_again)++;
    return {};
  }

  std::string constrain(std::uint8_t x, std::uint8_t y) {
    const Vertex n = static_cast<Vertex>(all_.points().size()), a = x % n, b = y % n;
    const std::vector<Triangulation::Triangle> before(all_.triangles().begin(), all_.triangles().end());
    const Vec2 p = all_.points()[a], q = all_.points()[b];
    const auto wall = all_.constrain(a, b);
    const auto crosses = [&](const std::array<Vertex, 2>& s) { return cross(p, q, all_.points()[s[0]], all_.points()[s[1]]); };
    if (wall.has_value() != std::any_of(segments_.begin(), segments_.end(), crosses)) {
      // A segment through a vertex of another one crosses it without crossing an edge.
      if (wall || !through_vertex(p, q)) return fmt::format("constrain {} {} should {}have been refused", a, b, wall ? "not " : "");
    }
    if (!wall) {
      segments_.push_back({a, b});
      marked_ = false;
      ++counts_.constrained;
      return {};
    }
    ++counts_.refused;
    if (!crosses(*wall)) return "the edge in the way is not";
    for (std::size_t i = 0; i < before.size(); ++i)
      if (before[i].v != all_.triangles()[i].v || before[i].wall != all_.triangles()[i].wall) return "a refusal changed something";
    return {};
  }

  bool through_vertex(const Vec2& p, const Vec2& q) const {
    for (const Vec2& v : all_.points())
      if (v != p && v != q && on_segment(p, q, v)) return true;
    return false;
  }

  std::string mark() {
    all_.mark_inside();
    marked_ = true;
    ++counts_.marked;
    return {};
  }

  // Where the walls close loops, exactly they separate inside from outside; the larger box is outside.
  std::string not_marked() const {
    std::vector<int> walls(all_.points().size(), 0);
    for (const auto& t : all_.triangles())
      for (int k = 0; k < 3; ++k)
        if ((t.wall >> k & 1) && (t.next[k] == Triangulation::kNone || t.v[(k + 1) % 3] < t.v[(k + 2) % 3]))
          ++walls[t.v[(k + 1) % 3]], ++walls[t.v[(k + 2) % 3]];
    const bool loops = std::all_of(walls.begin(), walls.end(), [](int n) { return n % 2 == 0; });
    for (const auto& t : all_.triangles())
      for (int k = 0; k < 3; ++k) {
        if (t.next[k] == Triangulation::kNone) continue;
        const bool differ = t.inside != all_.triangles()[t.next[k]].inside, wall = t.wall >> k & 1;
        if (wall ? loops && !differ : differ) return "inside is marked wrongly";
      }
    return {};
  }

  void swap_and_restore(std::uint8_t x, std::uint8_t y) {
    const Vertex t = (x * 256u + y) % static_cast<Vertex>(all_.triangles().size());
    if (!all_.swap_if_legal(t, x % 3)) return;
    ++counts_.swapped;
    const std::vector<Vertex> around(all_.changed().begin(), all_.changed().end());
    all_.make_delaunay(around);
  }

  Triangulation all_{Box2{{0, 0}, {17, 17}}};
  std::vector<std::array<Vertex, 2>> segments_;
  bool nudged_ = false, marked_ = false;
  OperationCounts& counts_;
};

}  // namespace

std::string run_triangulation_operations(std::span<const std::uint8_t> bytes, OperationCounts& counts) {
  Machine machine(counts);
  const std::size_t operations = std::min(bytes.size() / 3, kMostOperations);
  for (std::size_t i = 0; i < operations; ++i)
    if (const std::string wrong = machine.step(bytes[3 * i], bytes[3 * i + 1], bytes[3 * i + 2]); !wrong.empty())
      return fmt::format("operation {}: {}", i, wrong);
  return {};
}

std::vector<std::uint8_t> random_triangulation_operations(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<std::uint8_t> bytes(3 * (8 + random() % (kMostOperations - 8)));
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(random());
  // Half of the strings stay on the grid exactly; the first third of each inserts.
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    if (i < bytes.size() / 3) bytes[i] = static_cast<std::uint8_t>(bytes[i] & ~7u);
    if (seed % 2) bytes[i] = static_cast<std::uint8_t>(bytes[i] & ~8u);
  }
  return bytes;
}

}  // namespace iso::test
