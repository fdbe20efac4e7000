// What n-sided patches promise across their sides, kind by kind, in closed form.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <map>

#include "patches/surface/patch_basis-inl.h"
#include "tests/support/n_sided.h"

namespace iso::test {
namespace {

// The second row of side 1: across = sum_j B_j r_j is promised as the derivative in the parameter across.
std::vector<Vec3> row_of_side_1(const PatchBasis& basis, const std::vector<Vec3>& p) {
  const int d = basis.degree;
  std::vector<int> side = points_of_side(basis, 1), row;
  if (basis.kind == PatchKind::generalised_bezier) {
    // The file's order: row 1 stands after the n d points of row 0, the points next to the corners are the neighbours'.
    const std::vector<int> before = points_of_side(basis, 0), after = points_of_side(basis, 2 % basis.sides);
    row.push_back(before[d - 1]);
    for (int j = 0; j < d - 2; ++j) row.push_back(1 + basis.sides * d + j);
    row.push_back(1 + basis.sides * d + d - 2);
    row.push_back(after[1]);
  } else {
    row = {2, 3, 5 + 4, 5 + 1};
  }
  std::vector<Vec3> field;
  for (int j = 0; j <= d; ++j) field.push_back(double(d) * (p[row[j]] - p[side[j]]));
  return field;
}

// With the corner so near that doubles would say little about the parameters there, these are numbers of 113 bits.
#if __LDBL_MANT_DIG__ >= 113
using Quad = long double;
#else
__extension__ using Quad = __float128;
#endif
using Rate = Dual1<Quad>;  // a value, and in u its derivative in the direction asked for

Quad root(Quad x) {
  Quad y = std::sqrt(static_cast<double>(x));
  for (int step = 0; step < 3; ++step) y = Quad(0.5) * (y + x / y);
  return y;
}
Rate root(const Rate& x) {
  const Quad y = root(x.f), half = Quad(0.5) / y;
  return {y, half * x.u, half * x.v};
}

// Of the plane.
template <class T>
struct Pair {
  T x, y;
  friend Pair operator+(const Pair& a, const Pair& b) { return {a.x + b.x, a.y + b.y}; }
  friend Pair operator-(const Pair& a, const Pair& b) { return {a.x - b.x, a.y - b.y}; }
  friend Pair operator*(const T& by, const Pair& a) { return {by * a.x, by * a.y}; }
};
using Place = Pair<Quad>;
using Moving = Pair<Rate>;
template <class T>
T dot(const Pair<T>& a, const Pair<T>& b) {
  return a.x * b.x + a.y * b.y;
}
template <class T>
T area(const Pair<T>& a, const Pair<T>& b) {
  return a.x * b.y - a.y * b.x;
}
Moving still(const Place& p) { return {{p.x, 0, 0}, {p.y, 0, 0}}; }

// The corners of the polygon: roots of one, by Newton from doubles.
std::vector<Place> polygon_of(int n) {
  std::vector<Place> corners;
  for (int k = 0; k < n; ++k) {
    const Vec2 near = domain_corner(n, k);
    Place z{near.x, near.y};
    for (int step = 0; step < 3; ++step) {
      Place power{1, 0};  // z^(n-1)
      for (int i = 1; i < n; ++i) power = {power.x * z.x - power.y * z.y, power.x * z.y + power.y * z.x};
      // z - (z - 1 / z^(n-1)) / n, and 1 / z is the conjugate over the square.
      const Quad square = dot(power, power);
      z = z - Quad(1) / Quad(n) * (z - Place{power.x / square, -power.y / square});
    }
    corners.push_back(z);
  }
  return corners;
}

// The polygon and a place beside its side 1, moving into it as a chart's parameter grows: s in the chart of corner 0, or t in that of
// corner 1, which sees the side from its other end. About that corner, so that what is near to it is told to all bits. What is 0 / 0 on the
// side is found next to it, and what is so at the corner too.
struct Beside {
  std::vector<Place> corners;
  Moving x;
};
Beside beside_side_1(std::vector<Place> corners, bool from_start, double along) {
  const Place v = corners[from_start ? 0 : 1];
  for (Place& corner : corners) corner = corner - v;
  const Place out = Quad(0.5) * corners[from_start ? 1 : 0], in = Quad(0.5) * corners[from_start ? corners.size() - 1 : 2];
  const Place across = Quad(-1) * (v + out + in);
  const Quad s = along > 0 ? Quad(along) : Quad(1e-40), t = Quad(1e-16) * s;
  const Place x = s * out + t * in + s * t * across, by_t = in + s * across;
  return {corners, {{x.x, by_t.x, 0}, {x.y, by_t.y, 0}}};
}

// Barycentric coordinates as they are defined [Hettinga 2021, 2.3.5]: by areas, or by tangents of half the angles that sides take up.
std::vector<Rate> coordinates(const Beside& at, SideParameters parameters) {
  const auto n = at.corners.size();
  std::vector<Moving> to;
  for (const Place& v : at.corners) to.push_back(still(v) - at.x);
  std::vector<Rate> of_side(n), phi(n);  // side k from corner k - 1
  for (std::size_t k = 0; k < n; ++k) {
    const Moving &a = to[(k + n - 1) % n], &b = to[k];
    of_side[k] = parameters == SideParameters::mean_value ? (root(dot(a, a)) * root(dot(b, b)) - dot(a, b)) / area(a, b) : area(a, b);
  }
  Rate sum(0.0);
  for (std::size_t k = 0; k < n; ++k) {
    const Rate &own = of_side[k], &next = of_side[(k + 1) % n];
    phi[k] = parameters == SideParameters::mean_value ? (own + next) / root(dot(to[k], to[k])) : Rate(1.0) / (own * next);
    sum = sum + phi[k];
  }
  for (Rate& w : phi) w = w / sum;
  return phi;
}

// The parameters of the sides at a place: h_k, or the distance from side k.
class Parameters {
 public:
  Parameters(const PatchBasis& basis, const Beside& at) : basis_(basis), at_(at), phi_(coordinates(at, basis.parameters)) {}

  const Rate& coordinate(int k) const { return phi_[place(k)]; }
  Rate distance(int k) const {
    if (basis_.parameters == SideParameters::distance) {
      const Moving from = still(at_.corners[place(k - 1)]), side = still(at_.corners[place(k)]) - from;
      return area(side, at_.x - from) / root(dot(side, side));
    }
    Rate others(0.0);
    for (int j = 1; j + 1 < basis_.sides; ++j) others = others + coordinate(k + j);
    return others;
  }

 private:
  std::size_t place(int k) const { return static_cast<std::size_t>((k + basis_.sides) % basis_.sides); }

  const PatchBasis& basis_;
  const Beside& at_;
  std::vector<Rate> phi_;
};

Rate share_of(const Rate& a, const Rate& b) { return a / (a + b); }

// The derivative into the patch at a place of side 1 as the kind promises it, in terms of the side's own two rows.
Vec3 promised(const PatchBasis& basis, const std::vector<Vec3>& points, const std::vector<Place>& corners, bool from_start, double along) {
  const std::vector<Vec3> curve = chosen(points, points_of_side(basis, 1));
  const double u = from_start ? along / 2 : 1 - along / 2;
  const Vec3 tangent = curve_at(legs(curve), u), across = curve_at(row_of_side_1(basis, points), u);
  const Beside place = beside_side_1(corners, from_start, along);
  const Parameters at(basis, place);
  const auto sum = [&](const Quad& of_tangent, const Quad& of_across) {
    return static_cast<double>(of_tangent) * tangent + static_cast<double>(of_across) * across;
  };
  if (basis.kind != PatchKind::charrot_gregory) return sum(share_of(at.coordinate(1), at.coordinate(0)).u, at.distance(1).u);
  // Corners 0 and 1 weigh with their squared distances from the sides 2 and 0; in corner 1 the side runs backwards.
  Quad product[2] = {1, 1};
  for (int k = 2; k < basis.sides; ++k) product[0] *= at.distance(k).f * at.distance(k).f;
  for (int k = 3; k <= basis.sides; ++k) product[1] *= at.distance(k).f * at.distance(k).f;
  const Quad w0 = product[0] / (product[0] + product[1]), w1 = product[1] / (product[0] + product[1]);
  const auto d = [&](int k) { return at.distance(k); };
  const Rate u0 = share_of(d(0), d(2)), v0 = share_of(d(1), d(-1)), u1 = share_of(d(1), d(3)), v1 = share_of(d(2), d(0));
  return sum(w0 * u0.u - w1 * v1.u, w0 * v0.u + w1 * u1.u);
}

// The derivatives in s and t, by numbers that have the second ones too, and by those that do not.
struct Legs {
  Vec3 by_s{0.0}, by_t{0.0};
};
std::vector<Legs> derivatives(const PatchBasis& basis, const std::vector<Vec3>& points, const Vec2& st) {
  const Jet2 jet = jet_at(basis, points, st);
  std::vector<Legs> both{{jet.Su, jet.Sv}};
  // With mean value coordinates they have no limit at the corner.
  if (st == Vec2(0.0) && basis.parameters == SideParameters::mean_value) return both;
  std::vector<Dual1<double>> W(points.size());
  patch_weights<Dual1<double>>(basis, {st.x, 1.0, 0.0}, {st.y, 0.0, 1.0}, W.data());
  Legs alone;
  for (std::size_t m = 0; m < W.size(); ++m) {
    alone.by_s += W[m].u * points[m];
    alone.by_t += W[m].v * points[m];
  }
  both.push_back(alone);
  return both;
}

// Where a side is looked at, from its corner on to the middle.
constexpr double kAlong[] = {0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-4, 1e-3, 0.01, 0.05, 0.1, 0.3, 0.4, 0.5, 0.77, 0.9, 1};
// The control points' box measures two.
constexpr double kRibbon = 1e-12;

// Gregory quads, generalised Bezier and Gregory, Charrot-Gregory: d S = C' du + R dh with the kind's own parameters, up to the corners; at
// them where they have a limit.
TEST(PatchBasis, DerivativesAcrossSidesAreThoseOfTheRibbon) {
  Numbers random(3);
  int checked = 0;
  std::map<std::string, double> most;
  for (const PatchBasis& basis : every_basis()) {
    if (basis.kind == PatchKind::bezier_triangle || basis.kind == PatchKind::gregory_triangle) continue;
    const std::vector<Place> corners = polygon_of(basis.sides);
    double& error = most[name_of(basis.kind)];
    std::vector<Vec3> points = random.points(basis);
    for (int turns = 0; turns < 2; ++turns, points = turned(basis, points)) {
      const std::vector<Vec3> next = turned(basis, points);
      for (const double along : kAlong) {
        if (along == 0 && basis.parameters == SideParameters::mean_value) continue;
        const Vec3 ahead = promised(basis, points, corners, true, along), back = promised(basis, points, corners, false, along);
        const auto check = [&](const Vec3& derivative, const Vec3& ribbon) {
          const double off = glm::length(derivative - ribbon);
          ASSERT_LT(off, kRibbon) << told(basis) << " at " << along;
          error = std::max(error, off);
          ++checked;
        };
        for (const Legs& at : derivatives(basis, points, {along, 0})) check(at.by_t, ahead);
        for (const Legs& at : derivatives(basis, next, {0, along})) check(at.by_s, back);
      }
    }
  }
  for (const auto& [kind, error] : most) fmt::print("[ measured ] {}: ribbons to {:.2g}\n", kind, error);
  EXPECT_GT(checked, 12000);
}

// Triangles: with coordinates (a, b, c) the derivative along the side from c to a, c growing and a falling, is degree times the curve of
// row less side. Of a Gregory triangle row and side are quartic.
struct Rows {
  std::vector<Vec3> side, row;  // of side 1, from corner 0 on
};
Rows rows_of_triangle(const PatchBasis& basis, const std::vector<Vec3>& p) {
  if (basis.kind == PatchKind::gregory_triangle)
    return {{p[0], 0.25 * p[0] + 0.75 * p[1], 0.5 * (p[1] + p[7]), 0.75 * p[7] + 0.25 * p[5], p[5]},
            {0.25 * p[0] + 0.75 * p[2], p[3], p[9], 0.25 * p[5] + 0.75 * p[6]}};
  const auto d = static_cast<std::ptrdiff_t>(basis.degree);
  return {{p.begin(), p.begin() + d + 1}, {p.begin() + d + 1, p.begin() + 2 * d + 1}};
}
TEST(PatchBasis, DerivativesAcrossSidesOfTrianglesAreThoseOfTheRows) {
  Numbers random(4);
  int checked = 0;
  double most = 0;
  for (const PatchBasis& basis : every_basis()) {
    if (basis.kind != PatchKind::bezier_triangle && basis.kind != PatchKind::gregory_triangle) continue;
    std::vector<Vec3> points = random.points(basis);
    for (int corner = 0; corner < 3; ++corner, points = turned(basis, points)) {
      const auto [side, row] = rows_of_triangle(basis, points);
      std::vector<Vec3> field;
      for (std::size_t j = 0; j < row.size(); ++j) field.push_back(static_cast<double>(row.size()) * (row[j] - side[j]));
      // Ahead in the chart of corner 0, and back in that of corner 1, where the side runs down to v_0 and a is that of the corner before.
      const std::vector<Vec3> next = turned(basis, points);
      for (const double along : kAlong)
        for (const bool from_start : {true, false}) {
          const Vec2 st = from_start ? Vec2(along, 0) : Vec2(0, along),
                     way = domain_corner(3, from_start ? 2 : 1) - domain_corner(3, from_start ? 0 : 2);
          const DomainFrame frame = domain_frame(3, st);
          const Vec2 rates = glm::inverse(glm::dmat2(frame.by_s, frame.by_t)) * way;
          const Vec3 expected = curve_at(field, from_start ? along / 2 : 1 - along / 2);
          for (const Legs& at : derivatives(basis, from_start ? points : next, st)) {
            const double off = glm::length(rates.x * at.by_s + rates.y * at.by_t - expected);
            ASSERT_LT(off, kRibbon) << told(basis) << " at " << along;
            most = std::max(most, off);
            ++checked;
          }
        }
    }
  }
  fmt::print("[ measured ] triangles: ribbons to {:.2g}\n", most);
  EXPECT_EQ(checked, 9 * 3 * 16 * 2 * 2);
}

}  // namespace
}  // namespace iso::test
