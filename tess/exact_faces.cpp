#include "tess/exact_faces.h"

#include <algorithm>
#include <map>

#include "tess/tessellate.h"

namespace iso {
namespace {

// A part's mesh, and what makes its surfaces quick to evaluate.
struct Made {
  std::shared_ptr<const PartTessellation> tessellation;
  std::shared_ptr<const std::vector<SurfaceEval>> surfaces;
};

Made made_of(const Part& part, double distance) {
  auto surfaces = std::make_shared<std::vector<SurfaceEval>>();
  surfaces->reserve(part.faces.size());
  for (const Face& face : part.faces) surfaces->emplace_back(face.surface);
  return {std::make_shared<PartTessellation>(tessellate(part, {.distance = distance})), std::move(surfaces)};
}

double cross(UV a, UV b) { return a.x * b.y - a.y * b.x; }

// Barycentric weights of uv in a triangle of the parameter plane; not finite if that has no area.
Vec3 weights_in(const UV (&t)[3], UV uv) {
  const double area = cross(t[1] - t[0], t[2] - t[0]);
  const double b = cross(uv - t[0], t[2] - t[0]) / area, c = cross(t[1] - t[0], uv - t[0]) / area;
  return {1 - b - c, b, c};
}

}  // namespace

ExactFaces::ExactFaces(std::span<const PlacedPart> parts, double distance) {
  // Each part is meshed once, fine enough for its largest placement.
  std::map<const Part*, double> stretch;
  for (const PlacedPart& p : parts) stretch[p.part] = std::max(stretch[p.part], stretch_of(p.to_world));
  std::map<const Part*, Made> made;
  for (const PlacedPart& p : parts)
    if (!made.count(p.part)) made.emplace(p.part, made_of(*p.part, distance / stretch[p.part]));

  for (std::size_t i = 0; i < parts.size(); ++i) {
    const PlacedPart& p = parts[i];
    const Made& of = made.at(p.part);
    const PartTessellation& t = *of.tessellation;
    const auto first_point = static_cast<std::uint32_t>(points_.size()), first_triangle = static_cast<std::uint32_t>(triangles_.size());
    for (const Point3& point : t.mesh.points) points_.push_back(p.to_world.point(point));
    for (const Triangle& nodes : t.mesh.triangles) {
      PointTriangle corners;
      for (std::size_t k = 0; k < 3; ++k) corners[k] = first_point + t.mesh.nodes[nodes[k]].point;
      triangles_.push_back(corners);
    }
    for (const auto& side : t.free_sides) free_sides_.push_back({first_point + side[0], first_point + side[1], first_point + side[1]});
    places_.push_back({p.part, {of.tessellation, &t.mesh}, of.surfaces, p.to_world, inverse(p.to_world), first_triangle});
    const double larger = stretch_of(p.to_world);
    for (std::size_t f = 0; f < p.part->faces.size(); ++f) {
      const FaceReport& report = t.faces[f];
      Known known{static_cast<int>(i), static_cast<int>(f), larger * (report.bound + report.offset), larger * report.offset};
      known.first = first_triangle + t.mesh.first_triangle[f];
      known.end = first_triangle + t.mesh.first_triangle[f + 1];
      known.turned = p.part->faces[f].reversed != report.turned;
      for (std::uint32_t k = known.first; k < known.end; ++k) {
        const auto& [a, b, c] = triangles_[k];
        known.area += 0.5 * glm::length(glm::cross(points_[b] - points_[a], points_[c] - points_[a]));
        face_of_.push_back(static_cast<std::uint32_t>(faces_.size()));
      }
      bound_ = std::max(bound_, known.bound);
      gap_ = std::max(gap_, known.gap);
      faces_.push_back(known);
    }
    add_neighbours(t.mesh);
  }
  tree_ = std::make_unique<TriangleTree>(points_, triangles_);
}

void ExactFaces::add_neighbours(const PartMesh& mesh) {
  // Two triangles of a face are beside each other if they have two nodes in common.
  std::vector<std::pair<std::uint64_t, std::uint32_t>> sides;  // the nodes, and 3 triangle + corner opposite
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i)
    for (std::uint32_t k = 0; k < 3; ++k) {
      const auto [lo, hi] = std::minmax(mesh.triangles[i][(k + 1) % 3], mesh.triangles[i][(k + 2) % 3]);
      sides.push_back({std::uint64_t{lo} << 32 | hi, 3 * i + k});
    }
  std::sort(sides.begin(), sides.end());
  const auto first = static_cast<std::uint32_t>(beside_.size());
  constexpr std::uint32_t kNone = TriangleTree::kNone;
  beside_.resize(first + mesh.triangles.size(), {kNone, kNone, kNone});
  for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
    if (sides[i].first != sides[i + 1].first) continue;
    const std::uint32_t a = sides[i].second, b = sides[i + 1].second;
    beside_[first + a / 3][a % 3] = first + b / 3;
    beside_[first + b / 3][b % 3] = first + a / 3;
  }
}

void ExactFaces::walk(std::uint32_t& triangle, Vec3& weights) const {
  constexpr int kMostTriangles = 16;
  for (int step = 0; step < kMostTriangles; ++step) {
    const int k = weights.x <= weights.y && weights.x <= weights.z ? 0 : weights.y <= weights.z ? 1 : 2;
    if (weights[k] >= 0) return;
    const std::uint32_t next = beside_[triangle][static_cast<std::size_t>(k)];
    if (next == TriangleTree::kNone) break;
    const Corners c = corners_of(triangle);
    const Vec3 there = weights_in(corners_of(next).uv, weights.x * c.uv[0] + weights.y * c.uv[1] + weights.z * c.uv[2]);
    if (!finite(there)) break;
    triangle = next;
    weights = there;
  }
  weights = glm::max(weights, Vec3(0.0));
  weights /= weights.x + weights.y + weights.z;
}

ExactFaces::Corners ExactFaces::corners_of(std::uint32_t triangle) const {
  const Known& face = faces_[face_of_[triangle]];
  const Place& place = places_[static_cast<std::size_t>(face.placed)];
  const auto f = static_cast<std::size_t>(face.face);
  Corners c{&place, &(*place.surfaces)[f], &place.part->faces[f].surface, {}, face.turned};
  const Triangle& t = place.mesh->triangles[triangle - place.first_triangle];
  for (std::size_t k = 0; k < 3; ++k) c.uv[k] = place.mesh->nodes[t[k]].uv;
  return c;
}

TangentJet ExactFaces::at(const Corners& c, UV uv) const {
  const TangentJet local = c.surface->at(uv);
  const Affine3& place = c.place->to_world;
  return {place.point(local.S), place.vector(local.Su), place.vector(local.Sv)};
}

Vec3 ExactFaces::normal(const Corners& c, const TangentJet& world) const {
  // The cross product turns with a mirror, an outward normal does not.
  const double side = (c.turned ? -1.0 : 1.0) * (glm::determinant(c.place->to_world.linear) < 0 ? -1.0 : 1.0);
  const Vec3 n = glm::cross(world.Su, world.Sv);
  const double length = glm::length(n);
  return length > 0 ? n * (side / length) : Vec3(0.0);
}

ExactFaces::OnSurface ExactFaces::lifted(std::uint32_t triangle, const Vec3& weights) const {
  const Corners c = corners_of(triangle);
  const TangentJet there = at(c, weights.x * c.uv[0] + weights.y * c.uv[1] + weights.z * c.uv[2]);
  return {there.S, normal(c, there)};
}

// Steps toward the foot of p, taken only downhill: Gauss-Newton while that converges at once, as it does where p is much nearer than the
// surface's radius of curvature; then Newton with second derivatives, or Gauss-Newton where those do not lead down.
UV ExactFaces::downhill(const Corners& c, const Point3& p, UV uv, TangentJet& there) const {
  constexpr int kMostSteps = 24, kQuickSteps = 4, kMostHalvings = 8;
  constexpr double kParallel = 1e-12;  // squared sine of the tangents' angle, below which a step is not to be trusted
  const Affine3& place = c.place->to_world;
  double least = glm::length(there.S - p);
  for (int i = 0; i < kMostSteps; ++i) {
    const Vec3 r = p - there.S;
    double E = glm::dot(there.Su, there.Su), F = glm::dot(there.Su, there.Sv), G = glm::dot(there.Sv, there.Sv), det = E * G - F * F;
    if (!(det > kParallel * E * G)) break;
    if (i >= kQuickSteps) {
      const Jet2 jet = jet2(*c.exact, uv);
      const double e = E - glm::dot(r, place.vector(jet.Suu)), f = F - glm::dot(r, place.vector(jet.Suv)),
                   g = G - glm::dot(r, place.vector(jet.Svv));
      if (e > 0 && g > 0 && e * g - f * f > kParallel * e * g) E = e, F = f, G = g, det = e * g - f * f;
    }
    const double bu = glm::dot(there.Su, r), bv = glm::dot(there.Sv, r);
    UV step((G * bu - F * bv) / det, (E * bv - F * bu) / det);
    bool done = true;
    for (int half = 0; half < kMostHalvings; ++half, step *= 0.5) {
      const TangentJet moved = at(c, uv + step);
      const double d = glm::length(moved.S - p);
      if (!(d < least)) continue;
      // What is left to gain is below that by far: the steps converge.
      done = half == 0 && d > (1 - (i < kQuickSteps ? 1e-9 : 1e-14)) * least;
      least = d;
      there = moved;
      uv += step;
      break;
    }
    if (done) break;
  }
  return uv;
}

ExactFaces::Foot ExactFaces::nearest(const Point3& p, std::uint32_t hint) const {
  const TriangleTree::Nearest on = tree_->nearest(p, hint);
  Foot foot;
  if (on.triangle == TriangleTree::kNone) return foot;
  foot.triangle = on.triangle;
  const Corners c = corners_of(on.triangle);
  const auto uv_of = [&](const Vec3& l) { return l.x * c.uv[0] + l.y * c.uv[1] + l.z * c.uv[2]; };
  TangentJet best = at(c, uv_of(on.weights));
  // Steps begin a little inside the triangle: at poles and apexes there are no tangents.
  constexpr double kInside = 0.01;
  const UV start = uv_of((1 - kInside) * on.weights + Vec3(kInside / 3));
  TangentJet there = at(c, start);
  const UV uv = downhill(c, p, start, there);

  // Steps may lead out of the triangle, but not out of the face, farther than its mesh's border is off the true one.
  const Vec3 l = weights_in(c.uv, uv);
  const double allowed = faces_[face_of_[on.triangle]].bound;
  bool inside = l.x >= 0 && l.y >= 0 && l.z >= 0;
  if (!inside) {
    const TriangleTree::Nearest under = tree_->nearest(there.S, on.triangle);
    inside = under.distance <= allowed && face_of_[under.triangle] == face_of_[on.triangle];
  }
  if (!inside && finite(l)) {
    const Vec3 clamped = glm::max(l, Vec3(0.0));
    there = at(c, uv_of(clamped / (clamped.x + clamped.y + clamped.z)));
    inside = true;
  }
  if (inside && glm::length(there.S - p) < glm::length(best.S - p)) best = there;
  foot.point = best.S;
  foot.normal = normal(c, best);
  foot.distance = glm::length(best.S - p);
  return foot;
}

}  // namespace iso
