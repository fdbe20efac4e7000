// Normals where the parametrisation degenerates, and curvatures of known surfaces.
#include "patches/surface/surface.h"
#include "tests/support/random_shapes.h"
#include "tests/support/solids.h"
#include "tests/support/tally.h"

namespace iso::test {
namespace {

constexpr std::uint64_t kSeed = 20240609;

// The normal at uv is the limit of normals at regular points on the way from `inside`: the angle falls at least like the distance
// (the factor is what these random shapes bend at most).
void is_the_limit(Tally& tally, const std::string& name, const AnySurface& surface, const UV& uv, const UV& inside, const Box2& domain) {
  const Vec3 n = unit_normal(surface, uv, domain);
  tally.check(std::abs(glm::length(n) - 1) < 1e-12, [&] { return name + ": no unit normal"; });
  for (const double share : {1e-2, 1e-3, 1e-4}) {
    const Jet2 j = jet2(surface, uv + share * (inside - uv));
    const Vec3 near = glm::normalize(glm::cross(j.Su, j.Sv));
    tally.within(glm::length(near - n), 100 * share, [&] {
      return fmt::format("{} at ({}, {}): ({}, {}, {}), but ({}, {}, {}) at {} of the way in", name, uv.x, uv.y, n.x, n.y, n.z, near.x,
                         near.y, near.z, share);
    });
  }
}

TEST(Normal, PolesOfSpheresAreLimits) {
  Random random(kSeed);
  Tally tally("sphere poles", kSeed);
  for (int i = 0; i < 100; ++i) {
    const Sphere s{random_frame(random), between(random, 1e-3, 1e3)};
    const Box2 domain = natural_domain(s);
    const NurbsSurface nurbs = as_nurbs(s, domain);
    const Box2 unit = natural_domain(nurbs);
    for (const double pole : {-1.0, 1.0}) {
      const double u = between(random, 0, kTwoPi), v = pole * kPi / 2, t = pole < 0 ? unit.lo.y : unit.hi.y;
      is_the_limit(tally, "sphere", s, {u, v}, {u, 0}, domain);
      is_the_limit(tally, "NURBS sphere", nurbs, {u / kTwoPi * 4, t}, {u / kTwoPi * 4, 1}, unit);
      const Vec3 truth = pole * s.frame.Z * (glm::dot(glm::cross(s.frame.X, s.frame.Y), s.frame.Z) > 0 ? 1.0 : -1.0);
      tally.within(glm::length(unit_normal(s, {u, v}, domain) - truth), 1e-12, [&] { return std::string("analytic pole"); });
      tally.within(glm::length(unit_normal(nurbs, {u / kTwoPi * 4, t}, unit) - truth), 1e-6, [&] { return std::string("NURBS pole"); });
    }
  }
  tally.finish(100 * 2 * 10);
}

TEST(Normal, ApexOfConesAreLimits) {
  Random random(kSeed + 1);
  Tally tally("apex", kSeed + 1);
  for (int i = 0; i < 100; ++i) {
    const Cone s{random_frame(random), between(random, 0.1, 3), between(random, 0.1, 1.3) * (i % 2 ? 1 : -1)};
    const double apex = -s.r / std::sin(s.half_angle), u = between(random, 0, kTwoPi);
    const Box2 domain{{0, std::min(apex, 0.0)}, {kTwoPi, std::max(apex, 0.0)}};
    is_the_limit(tally, "cone", s, {u, apex}, {u, 0}, domain);
    const NurbsSurface nurbs = as_nurbs(s, domain);
    const double w = u / kTwoPi * 4;
    // The limit depends on u alone; going in with u held is the limit that the renderer sees.
    is_the_limit(tally, "NURBS cone", nurbs, {w, apex < 0 ? 0.0 : 1.0}, {w, 0.5}, natural_domain(nurbs));
  }
  tally.finish(100 * 2 * 4);
}

TEST(Normal, TipsOfSpindleAndHornToriAreLimits) {
  Random random(kSeed + 2);
  Tally tally("torus tips", kSeed + 2);
  for (int i = 0; i < 100; ++i) {
    Torus s{random_frame(random), between(random, 0.1, 0.9), 1};
    if (i % 4 == 0) s.R = 1;
    const double tip = std::acos(-s.R / s.r), u = between(random, 0, kTwoPi);
    is_the_limit(tally, "torus", s, {u, tip}, {u, tip - 0.5}, {{0, -tip}, {kTwoPi, tip}});
    is_the_limit(tally, "torus", s, {u, -tip}, {u, -tip + 0.5}, {{0, -tip}, {kTwoPi, tip}});
  }
  tally.finish(100 * 2 * 4);
}

TEST(Normal, CollapsedSidesOfBezierPatchesAreLimits) {
  Random random(kSeed + 3);
  Tally tally("collapsed sides", kSeed + 3);
  for (int i = 0; i < 200; ++i) {
    const int pu = whole(random, 2, 5), pv = whole(random, 2, 5);
    // A sheet over the (x, y) plane whose first column is one point: a fan, with a tangent plane at the tip (second column coplanar).
    NurbsSurface s = random_nurbs(random, Knots::bezier, Knots::bezier, pu, pv, i % 2 == 0);
    for (int a = 0; a <= pu; ++a)
      for (int b = 0; b <= pv; ++b) {
        const double angle = 0.3 + 1.0 * a / pu, radius = static_cast<double>(b) / pv, lift = b >= 2 ? between(random, -0.2, 0.2) : 0.0;
        Vec4& h = s.poles[static_cast<std::size_t>(a * (pv + 1) + b)];
        h = homogeneous({radius * std::cos(angle), radius * std::sin(angle), lift}, h.w);
      }
    const Box2 domain = natural_domain(s);
    const double u = i % 5 == 0 ? domain.lo.x : i % 5 == 1 ? domain.hi.x : between(random, domain.lo.x, domain.hi.x);
    is_the_limit(tally, "fan", s, {u, domain.lo.y}, {u, domain.hi.y}, domain);
    tally.within(glm::length(unit_normal(s, {u, domain.lo.y}, domain) - Vec3(0, 0, -1)), 1e-6,
                 [&] { return fmt::format("tip of a fan, u = {}", u); });
  }
  tally.finish(200 * 5);
}

TEST(Normal, RevolutionsThatTouchTheirAxisAreLimits) {
  Random random(kSeed + 4);
  Tally tally("revolution tips", kSeed + 4);
  for (int i = 0; i < 100; ++i) {
    NurbsCurve<Vec3> profile = random_nurbs_curve<Vec3>(random, Knots::bezier, 3, i % 2 == 0);
    profile.poles[0] = homogeneous(Vec3(0, 0, 1), weight(profile.poles[0]));
    profile.poles[1] = homogeneous(Vec3(between(random, 0.5, 1), 0, i % 3 == 0 ? 1.0 : between(random, 0, 2)), weight(profile.poles[1]));
    const Range v{profile.knots.front(), profile.knots.back()};
    const Revolution s{profile, {0, 0, 0}, {0, 0, 1}, v};
    const double u = between(random, 0, kTwoPi);
    is_the_limit(tally, "revolution", s, {u, v.lo}, {u, v.lo + 0.3 * v.width()}, {{0, v.lo}, {kTwoPi, v.hi}});
  }
  tally.finish(100 * 4);
}

// ---- curvatures --------------------------------------------------------------------------------------------------------

void has_curvatures(Tally& tally, const std::string& name, const AnySurface& s, const UV& uv, double k1, double k2, double sign = 1) {
  const Jet2 j = jet2(s, uv);
  const Vec3 n = sign * glm::normalize(glm::cross(j.Su, j.Sv));
  const Curvatures k = principal_curvatures(j, n);
  const double limit = 1e-7 * (std::abs(k1) + std::abs(k2));  // the two roots lie together at umbilics: half the digits
  tally.within(std::abs(k.k1 - k1) + std::abs(k.k2 - k2), limit,
               [&] { return fmt::format("{}: {}, {}; expected {}, {}", name, k.k1, k.k2, k1, k2); });
}

TEST(Curvature, KnownSurfacesWithTheirSigns) {
  Random random(kSeed + 5);
  Tally tally("curvatures", kSeed + 5);
  for (int i = 0; i < 200; ++i) {
    Frame f = random_frame(random);
    const double hand = glm::dot(glm::cross(f.X, f.Y), f.Z) > 0 ? 1 : -1;  // of outward against Su x Sv
    const double r = between(random, 0.1, 10), R = r * between(random, 1.5, 4), u = between(random, 0, kTwoPi),
                 v = between(random, -1.5, 1.5);
    has_curvatures(tally, "sphere, outward", Sphere{f, r}, {u, v}, -1 / r, -1 / r, hand);
    has_curvatures(tally, "sphere, inward", Sphere{f, r}, {u, v}, 1 / r, 1 / r, -hand);
    has_curvatures(tally, "cylinder, outward", Cylinder{f, r}, {u, v}, 0, -1 / r, hand);
    has_curvatures(tally, "cylinder, inward", Cylinder{f, r}, {u, v}, 1 / r, 0, -hand);
    const double ring = std::cos(v) / (R + r * std::cos(v)), back = std::cos(kPi + v) / (R + r * std::cos(kPi + v));
    has_curvatures(tally, "torus, outer half", Torus{f, R, r}, {u, v}, -ring, -1 / r, hand);
    has_curvatures(tally, "torus, inner half", Torus{f, R, r}, {u, kPi + v}, -back, -1 / r, hand);
    // Cone: along the rulings 0, around 1 / (distance to the axis along the normal).
    const Cone cone{f, 1 + std::abs(v), between(random, 0.1, 1.2)};
    const double radius = cone.r + v * std::sin(cone.half_angle);
    has_curvatures(tally, "cone, outward", cone, {u, v}, 0, -std::cos(cone.half_angle) / radius, hand);
    // The saddle (x, y, c x y) at its centre: +-c.
    NurbsSurface saddle;
    const double c = between(random, 0.1, 5);
    saddle.degree_u = saddle.degree_v = 1;
    saddle.count_u = saddle.count_v = 2;
    saddle.knots_u = saddle.knots_v = {-1, -1, 1, 1};
    for (const double x : {-1.0, 1.0})
      for (const double y : {-1.0, 1.0}) saddle.poles.push_back(homogeneous(Vec3(x, y, c * x * y), 1.0));
    has_curvatures(tally, "saddle", saddle, {0, 0}, c, -c);
  }
  tally.finish(200 * 8);
}

TEST(Curvature, NurbsFormsAgreeWithTheirOriginals) {
  Random random(kSeed + 6);
  Tally tally("curvatures of NURBS", kSeed + 6);
  for (int i = 0; i < 100; ++i) {
    const Torus s{random_frame(random), 3, between(random, 0.3, 1)};
    const Box2 domain = natural_domain(s);
    for (const BezierPiece& piece : bezier_pieces(s, domain)) {
      const Vec2 st{between(random, 0.05, 0.95), between(random, 0.05, 0.95)};
      const UV uv = piece.to_native(st);
      const Vec2 knot{std::round(piece.u.a / (kPi / 2)), std::round(piece.v.a / (kPi / 2))};
      const NurbsSurface nurbs = as_nurbs(s, domain);
      const Jet2 a = jet2(s, uv), b = jet2(nurbs, knot + st);
      const Vec3 n = glm::normalize(glm::cross(a.Su, a.Sv));
      const Curvatures p = principal_curvatures(a, n), q = principal_curvatures(b, n);
      tally.within(std::abs(p.k1 - q.k1) + std::abs(p.k2 - q.k2), 1e-11 * (std::abs(p.k1) + std::abs(p.k2)),
                   [&] { return std::string("torus"); });
    }
  }
  tally.finish(100 * 16);
}

}  // namespace
}  // namespace iso::test
