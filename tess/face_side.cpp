#include "tess/face_side.h"

namespace iso {

namespace {

// Chords of a use that is no straight line, for each of its spans.
constexpr int kChordsOfSpan = 16, kMostChords = 512;

// Places of a use from which it is asked, an odd number.
constexpr int kPlaces = 5;

struct Segment {
  UV a{0.0}, b{0.0};
};

int chords_of(const EdgeUse& use) {
  if (std::holds_alternative<Line<Vec2>>(use.curve.curve)) return 1;
  if (const auto* nurbs = std::get_if<NurbsCurve<Vec2>>(&use.curve.curve))
    return std::min(kMostChords, kChordsOfSpan * std::max(2, static_cast<int>(nurbs->poles.size()) - nurbs->degree));
  return 4 * kChordsOfSpan;
}

// The segments of one use, [first, end).
struct Chords {
  int use = 0;
  std::size_t first = 0, end = 0;
};

// All loops of a face as closed polylines, scaled so that its domain is a square.
struct Outline {
  std::vector<Segment> segments;
  std::vector<Chords> of_use;

  Outline(const Face& face, const Boundary& boundary, const std::vector<std::vector<int>>& loops) {
    const Vec2 size = face.domain.size();
    const Vec2 scale{size.x > 0 ? 1 / size.x : 1.0, size.y > 0 ? 1 / size.y : 1.0};
    for (const auto& loop : loops) {
      for (const int u : loop) {
        const EdgeUse& use = boundary.uses[static_cast<std::size_t>(u)];
        const int count = chords_of(use);
        const std::size_t first = segments.size();
        const auto at = [&](int i) { return scale * uv_at(use, static_cast<double>(i) / count); };
        for (int i = 0; i < count; ++i) segments.push_back({i == 0 ? at(0) : segments.back().b, at(i + 1)});
        of_use.push_back({u, first, segments.size()});
      }
      close(boundary, loop);
    }
  }

 private:
  // From where each use of the loop ends to where the next begins: nothing, but for rounding and what files leave open.
  void close(const Boundary& boundary, const std::vector<int>& loop) {
    const std::size_t n = loop.size();
    const auto end_of = [&](std::size_t k, bool last) {
      const Chords& chords = of_use[of_use.size() - n + k];
      const bool forward = boundary.uses[static_cast<std::size_t>(chords.use)].forward;
      return last == forward ? segments[chords.end - 1].b : segments[chords.first].a;
    };
    std::vector<Segment> between;
    for (std::size_t k = 0; k < n; ++k) between.push_back({end_of(k, true), end_of((k + 1) % n, false)});
    segments.insert(segments.end(), between.begin(), between.end());
  }
};

// Whether what lies just left of a place of a segment is inside.
bool inside_on_the_left(const std::vector<Segment>& segments, std::size_t own, double share) {
  const Segment& s = segments[own];
  const UV from = s.a + share * (s.b - s.a), left{s.a.y - s.b.y, s.b.x - s.a.x};
  bool odd = false;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    if (i == own) continue;
    const UV a = segments[i].a - from, b = segments[i].b - from;
    const double beside_a = left.x * a.y - left.y * a.x, beside_b = left.x * b.y - left.y * b.x;
    if ((beside_a >= 0) == (beside_b >= 0)) continue;
    const UV at = a + beside_a / (beside_a - beside_b) * (b - a);
    if (glm::dot(at, left) > 0) odd = !odd;
  }
  return odd;
}

}  // namespace

std::vector<bool> lies_left(const Part& part, const Boundary& boundary) {
  std::vector<bool> left(boundary.uses.size(), true);
  for (std::size_t f = 0; f < part.faces.size(); ++f) {
    const Outline outline(part.faces[f], boundary, boundary.loops[f]);
    for (const Chords& chords : outline.of_use) {
      int votes = 0;
      for (int k = 0; k < kPlaces; ++k) {
        const double at = (k + 0.5) / kPlaces * static_cast<double>(chords.end - chords.first);
        const auto i = std::min(static_cast<std::size_t>(at), chords.end - chords.first - 1);
        votes += inside_on_the_left(outline.segments, chords.first + i, at - static_cast<double>(i));
      }
      left[static_cast<std::size_t>(chords.use)] = 2 * votes > kPlaces;
    }
  }
  return left;
}

}  // namespace iso
