#include "tess/inner_poles.h"

#include <algorithm>

#include "patches/trim.h"
#include "tess/boundary.h"

namespace iso {
namespace {

// Radii that differ by less than this share are equal, and parameters by less than this share of the domain.
constexpr double kSame = 1e-12;

// The starts of the face's uses that lie on the line v = pi, up to periods, in the order of (v, u).
std::vector<UV> places_on_line(const Boundary& boundary, std::size_t face, double tiny) {
  std::vector<UV> places;
  for (const auto& loop : boundary.loops[face])
    for (const int u : loop) {
      const EdgeUse& use = boundary.uses[static_cast<std::size_t>(u)];
      const UV uv = uv_at(use, use.forward ? 0 : 1);
      if (std::abs(std::remainder(uv.y - kPi, kTwoPi)) <= tiny) places.push_back(uv);
    }
  std::sort(places.begin(), places.end(), [](const UV& a, const UV& b) { return a.y != b.y ? a.y < b.y : a.x < b.x; });
  return places;
}

bool is_inside_between(const TrimRegion& region, const Face& face, const UV& a, const UV& b) {
  constexpr int kLooked = 32;
  for (int i = 1; i < kLooked; ++i)
    if (!region.contains(a + (b - a) * (static_cast<double>(i) / kLooked), face.surface).inside) return false;
  return true;
}

// From a to b and back, one loop.
void add_slit(int face, const UV& a, const UV& b, Boundary& boundary) {
  const auto use = [&](const UV& from, const UV& to, bool forward) {
    return EdgeUse{face, static_cast<int>(boundary.edges.size()), {Line<Vec2>{from, to - from}, 0, 1, -1}, forward, true};
  };
  const int first = static_cast<int>(boundary.uses.size());
  boundary.uses.push_back(use(a, b, true));
  boundary.uses.push_back(use(b, a, false));
  boundary.edges.push_back({{first, first + 1}, {}, -1, true});
  boundary.loops[static_cast<std::size_t>(face)].push_back({first, first + 1});
}

}  // namespace

void add_inner_poles(const Part& part, Boundary& boundary) {
  for (std::size_t f = 0; f < part.faces.size(); ++f) {
    const Face& face = part.faces[f];
    const auto* torus = std::get_if<Torus>(&face.surface);
    if (!torus || std::abs(torus->R - torus->r) > kSame * torus->r) continue;
    const double tiny = kSame * face.domain.diagonal();
    const std::vector<UV> places = places_on_line(boundary, f, tiny);
    if (places.size() < 2) continue;
    const TrimRegion region(face, part.edges, 0);
    for (std::size_t i = 0; i + 1 < places.size(); ++i) {
      const UV &a = places[i], &b = places[i + 1];
      if (std::abs(b.y - a.y) > tiny || b.x - a.x <= tiny || !is_inside_between(region, face, a, b)) continue;
      add_slit(static_cast<int>(f), a, b, boundary);
    }
  }
}

}  // namespace iso
