// Parts of one face for tests: closed-form surfaces and the same shapes as rational B-splines.
#pragma once

#include <memory>
#include <random>

#include "patches/surface/bezier_patch.h"
#include "raytracer/tracer.h"

namespace iso::test {

// The Bezier pieces of a surface over `uv`, glued to one NURBS with C0 knots 0, 1, 2, ...
inline NurbsSurface as_nurbs(const AnySurface& surface, const Box2& uv) {
  const std::vector<BezierPiece> pieces = bezier_pieces(surface, uv);
  std::vector<double> us, vs;
  for (const BezierPiece& p : pieces) {
    us.push_back(p.u.a);
    vs.push_back(p.v.a);
  }
  for (auto* list : {&us, &vs}) {
    std::sort(list->begin(), list->end());
    list->erase(std::unique(list->begin(), list->end()), list->end());
  }
  const int pu = pieces.front().patch.pu, pv = pieces.front().patch.pv;
  NurbsSurface s;
  s.degree_u = pu;
  s.degree_v = pv;
  s.count_u = static_cast<int>(us.size()) * pu + 1;
  s.count_v = static_cast<int>(vs.size()) * pv + 1;
  const auto knots = [](int spans, int degree) {
    std::vector<double> k(static_cast<std::size_t>(degree) + 1, 0.0);
    for (int i = 1; i < spans; ++i) k.insert(k.end(), static_cast<std::size_t>(degree), i);
    k.insert(k.end(), static_cast<std::size_t>(degree) + 1, spans);
    return k;
  };
  s.knots_u = knots(static_cast<int>(us.size()), pu);
  s.knots_v = knots(static_cast<int>(vs.size()), pv);
  s.poles.resize(static_cast<std::size_t>(s.count_u) * s.count_v);
  for (const BezierPiece& p : pieces) {
    const int ku = static_cast<int>(std::lower_bound(us.begin(), us.end(), p.u.a) - us.begin());
    const int kv = static_cast<int>(std::lower_bound(vs.begin(), vs.end(), p.v.a) - vs.begin());
    for (int i = 0; i <= pu; ++i)
      for (int j = 0; j <= pv; ++j) s.poles[static_cast<std::size_t>(ku * pu + i) * s.count_v + kv * pv + j] = p.patch.at(i, j);
  }
  return s;
}

// A scene of one untrimmed face.
inline TraceScene one_face(AnySurface surface, const Box2& domain) {
  auto model = std::make_shared<Model>();
  model->parts.emplace_back();
  Face face;
  face.surface = std::move(surface);
  face.domain = domain;
  model->parts[0].faces.push_back(std::move(face));
  model->instances.emplace_back();
  finish(*model);
  TraceScene scene;
  add_model(scene, model, Affine3{});
  return scene;
}

inline Vec3 random_direction(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  for (;;) {
    const Vec3 d{normal(random), normal(random), normal(random)};
    if (glm::length(d) > 1e-3) return glm::normalize(d);
  }
}

// Lines through the ball of radius `reach` about `centre`, starting well outside it.
inline Ray random_ray(std::mt19937_64& random, const Vec3& centre, double reach) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  Vec3 target;
  do target = {uniform(random), uniform(random), uniform(random)};
  while (glm::length(target) > 1);
  const Vec3 d = random_direction(random);
  return {centre + reach * (target - 4.0 * d), d};
}

}  // namespace iso::test
