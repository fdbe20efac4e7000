#include "raytracer/leaf.h"

#include <tbb/parallel_for.h>

#include <array>
#include <iterator>

#include "patches/base/check.h"
#include "patches/base/per_degree.h"

namespace iso {

namespace {

// Boxes are larger than the geometry by this share of the part's size, slabs by twice as much: they meet float rays at float points.
constexpr double kBoxInflation = 1e-6;

// Powers about the middle lose digits with the degree; patches above it are left to subdivision, in Bernstein form.
constexpr int kMostPower = 12;

// Roots this near to the border of a leaf are decided by subdivision (leaf_kernel.h); rounding must move them less.
constexpr double kMostRoundingOfRoot = 1e-8;

Leaf make_leaf(const FaceCell& cell, std::uint32_t patch, bool has_powers, double part_size, double apart) {
  Leaf leaf{};
  double largest_row = 0, height = 0;
  float* rows[] = {leaf.a, leaf.b, leaf.h};
  for (int k = 0; k < 3; ++k) {
    const Vec3& row = cell.slab.row[k];
    const Range reach = cell.slab.reach[k];
    const double length = glm::length(row), half = 0.5 * reach.width() + (2 * kBoxInflation * part_size + apart) * length;
    for (int c = 0; c < 3; ++c) rows[k][c] = static_cast<float>(row[c] / half);
    rows[k][3] = static_cast<float>((-glm::dot(row, cell.centre) - reach.middle()) / half);
    if (k < 2)
      largest_row = std::max(largest_row, length);
    else
      height = half;
  }
  // The cosine above which FaceCell::tilt is sure, as a speed across h; large enough that rounding moves no root far.
  const double least = 64 * kEps * part_size * largest_row / kMostRoundingOfRoot, cosine = cell.tilt / std::hypot(1.0, cell.tilt);
  const bool sure = has_powers && finite(cell.tilt) && least < 1;
  leaf.steep = sure ? static_cast<float>(1.0001 * std::max(cosine, least) / height) : std::numeric_limits<float>::infinity();
  leaf.patch = patch;
  const Vec2 lo = cell.lo * kLeafGrid;
  leaf.corner = (static_cast<std::uint32_t>(lo.x) << 16) | static_cast<std::uint32_t>(lo.y);
  for (const int c : {0, 1}) leaf.level[c] = static_cast<std::uint8_t>(std::lround(-std::log2(cell.hi[c] - cell.lo[c])));
  leaf.crossing = cell.kind == TrimRegion::Kind::crossing ? 1 : 0;
  return leaf;
}

// Row i: the powers of x = s - 1/2 of the i-th Bernstein polynomial, C(p, i) (1/2 + x)^i (1/2 - x)^(p - i). Up to kMostPower these are
// fractions of 2^p that doubles hold exactly.
std::vector<double> bernstein_powers(int degree) {
  std::vector<double> rows;
  double binomial = 1;
  for (int i = 0; i <= degree; ++i) {
    std::vector<double> row{binomial};
    for (int k = 0; k < degree; ++k) {  // times (1/2 + x) or (1/2 - x)
      row.push_back(0);
      for (std::size_t n = row.size() - 1; n > 0; --n) row[n] = 0.5 * row[n] + (k < i ? row[n - 1] : -row[n - 1]);
      row[0] *= 0.5;
    }
    rows.insert(rows.end(), row.begin(), row.end());
    binomial = binomial * (degree - i) / (i + 1);
  }
  return rows;
}

void add_powers(PartGeometry& geometry, LeafPatch& patch) {
  const BezierPatch& net = patch.piece.patch;
  for (const Vec4& h : net.net) patch.rational |= h.w != 1;
  patch.powers = static_cast<std::uint32_t>(geometry.powers.size());
  const int pu = net.pu, pv = net.pv, components = patch.rational ? 4 : 3, row_length = (pv + 1) * components;
  const double *u = of_degree<std::vector<double>, bernstein_powers>(pu).data(),
               *v = of_degree<std::vector<double>, bernstein_powers>(pv).data();
  std::array<long double, (kMostPower + 1) * (kMostPower + 1) * 4> half;  // powers in t, still Bernstein in s
  for (int i = 0; i <= pu; ++i)
    for (int l = 0; l <= pv; ++l)
      for (int c = 0; c < components; ++c) {
        long double sum = 0;
        for (int j = 0; j <= pv; ++j) sum += static_cast<long double>(v[j * (pv + 1) + l]) * net.at(i, j)[c];
        half[i * row_length + l * components + c] = sum;
      }
  const std::size_t count = net.net.size() * components;
  geometry.powers.resize(patch.powers + count);
  geometry.float_powers.resize(patch.powers + count);
  for (int k = 0; k <= pu; ++k)
    for (int n = 0; n < row_length; ++n) {
      long double sum = 0;
      for (int i = 0; i <= pu; ++i) sum += static_cast<long double>(u[i * (pu + 1) + k]) * half[i * row_length + n];
      const std::size_t to = patch.powers + static_cast<std::size_t>(k * row_length + n);
      geometry.powers[to] = static_cast<double>(sum);
      geometry.float_powers[to] = static_cast<float>(sum);
    }
  patch.piece.patch.net = {};
}

// Row i: the i-th Bernstein coefficients of the powers of x = s - 1/2, blossoms at i ones and p - i zeros: the mean, over all choices of k
// of these, of the products of +-1/2.
std::vector<double> powers_in_bernstein(int degree) {
  const auto choose = [](int n, int k) {
    double c = k >= 0 && k <= n ? 1 : 0;
    for (int m = 0; m < k && c > 0; ++m) c = c * (n - m) / (m + 1);
    return c;
  };
  std::vector<double> rows;
  for (int i = 0; i <= degree; ++i)
    for (int k = 0; k <= degree; ++k) {
      double sum = 0;
      for (int m = 0; m <= k; ++m) sum += ((k - m) % 2 ? -1 : 1) * choose(i, m) * choose(degree - i, k - m);
      rows.push_back(std::ldexp(sum / choose(degree, k), -k));
    }
  return rows;
}

// False for the kinds that go through their Bezier pieces.
bool set_surface(const AnySurface& surface, AnalyticFace& out) {
  const auto is = [&](AnalyticKind kind, const Frame& frame, double radius) {
    out.kind = kind;
    out.frame = frame;
    out.radius = radius;
    return true;
  };
  if (const auto* plane = std::get_if<Plane>(&surface)) return is(AnalyticKind::plane, plane->frame, 0);
  if (const auto* cylinder = std::get_if<Cylinder>(&surface)) return is(AnalyticKind::cylinder, cylinder->frame, cylinder->r);
  if (const auto* sphere = std::get_if<Sphere>(&surface)) return is(AnalyticKind::sphere, sphere->frame, sphere->r);
  if (const auto* cone = std::get_if<Cone>(&surface)) {
    if (cone->half_angle == 0) return is(AnalyticKind::cylinder, cone->frame, cone->r);
    out.k = std::tan(cone->half_angle);
    out.cosine = std::cos(cone->half_angle);
    out.apex = -cone->r / out.k;
    return is(AnalyticKind::cone, cone->frame, 0);
  }
  return false;
}

bool add_analytic(PartGeometry& geometry, std::uint32_t index, const Face& face, const TrimRegion& trim) {
  AnalyticFace analytic;
  analytic.face = index;
  if (!set_surface(face.surface, analytic)) return false;
  analytic.box = trimmed_box(face, trim).inflated(trim.largest_reach());
  if (!analytic.box.empty()) geometry.analytic.push_back(analytic);
  return true;
}

void add_patches(PartGeometry& geometry, std::uint32_t index, const Face& face, const TrimRegion& trim, double part_size) {
  CellPolicy policy;
  policy.small = 1e-3 * part_size;
  const auto* chart = std::get_if<PatchChart>(&face.surface);
  const double apart = chart ? chart->error : 0;
  std::vector<FaceCell> cells;
  for (BezierPiece& piece : bezier_pieces(face.surface, trim.grown(face.domain))) {
    const std::uint32_t patch = static_cast<std::uint32_t>(geometry.patches.size());
    cells.clear();
    divide(piece, 0, trim, policy, cells);
    if (cells.empty()) continue;
    const bool has_powers = std::max(piece.patch.pu, piece.patch.pv) <= kMostPower;
    for (const FaceCell& cell : cells) {
      geometry.leaves.push_back(make_leaf(cell, patch, has_powers, part_size, apart));
      const Vec4 curls = 1.000001 * Vec4(cell.curls, apart);
      geometry.curls.push_back(
          {static_cast<float>(curls.x), static_cast<float>(curls.y), static_cast<float>(curls.z), static_cast<float>(curls.w)});
      geometry.leaf_boxes.push_back(cell.box);
    }
    geometry.patches.push_back({std::move(piece), index});
    if (has_powers) add_powers(geometry, geometry.patches.back());
  }
}

}  // namespace

void bernstein_form(const PartGeometry& geometry, const LeafPatch& patch, BezierPatch& net) {
  net = patch.piece.patch;
  if (patch.powers == LeafPatch::kNoPowers) return;
  const int pu = net.pu, pv = net.pv, components = patch.rational ? 4 : 3;
  const double* powers = &geometry.powers[patch.powers];
  const double *u = of_degree<std::vector<double>, powers_in_bernstein>(pu).data(),
               *v = of_degree<std::vector<double>, powers_in_bernstein>(pv).data();
  net.net.assign((static_cast<std::size_t>(pu) + 1) * (pv + 1), Vec4(0, 0, 0, 1));
  for (int i = 0; i <= pu; ++i)
    for (int j = 0; j <= pv; ++j)
      for (int c = 0; c < components; ++c) {
        long double sum = 0;
        for (int k = 0; k <= pu; ++k) {
          long double row = 0;
          for (int l = 0; l <= pv; ++l) row += static_cast<long double>(v[j * (pv + 1) + l]) * powers[(k * (pv + 1) + l) * components + c];
          sum += u[i * (pu + 1) + k] * row;
        }
        net.at(i, j)[c] = static_cast<double>(sum);
      }
}

namespace {

// What one face adds to its part.
PartGeometry geometry_of_face(const Part& part, std::uint32_t index) {
  PartGeometry geometry;
  const double size = part.box.diagonal();
  const Face& face = part.faces[index];
  const TrimRegion& trim = geometry.trims.emplace_back(face, part.edges, kTrimRounding * size);
  if (!add_analytic(geometry, index, face, trim)) add_patches(geometry, index, face, trim, size);
  return geometry;
}

template <class T>
void append(std::vector<T>& to, std::vector<T>& from) {
  to.insert(to.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
}

void append(PartGeometry& to, PartGeometry&& from) {
  const auto patches = static_cast<std::uint32_t>(to.patches.size()), powers = static_cast<std::uint32_t>(to.powers.size());
  for (Leaf& leaf : from.leaves) leaf.patch += patches;
  for (LeafPatch& patch : from.patches)
    if (patch.powers != LeafPatch::kNoPowers) patch.powers += powers;
  append(to.trims, from.trims);
  append(to.patches, from.patches);
  append(to.leaves, from.leaves);
  append(to.curls, from.curls);
  append(to.leaf_boxes, from.leaf_boxes);
  append(to.analytic, from.analytic);
  append(to.powers, from.powers);
  append(to.float_powers, from.float_powers);
}

}  // namespace

PartGeometry make_geometry(const Part& part) {
  PartGeometry geometry;
  geometry.part = &part;
  for (const Edge& edge : part.edges) geometry.largest_gap = std::max(geometry.largest_gap, edge.closing);
  std::vector<PartGeometry> faces(part.faces.size());
  tbb::parallel_for(std::size_t{0}, faces.size(), [&](std::size_t i) { faces[i] = geometry_of_face(part, static_cast<std::uint32_t>(i)); });
  for (PartGeometry& face : faces) append(geometry, std::move(face));
  ISO_CHECK(geometry.powers.size() < LeafPatch::kNoPowers && geometry.leaves.size() <= 0x7fffffffu);  // what their indices hold
  for (std::size_t k = 0; k < geometry.leaf_boxes.size(); ++k) {
    geometry.leaf_boxes[k] = geometry.leaf_boxes[k].inflated(geometry.curls[k].apart);
    geometry.box.include(geometry.leaf_boxes[k]);
  }
  for (const AnalyticFace& face : geometry.analytic) geometry.box.include(face.box);
  geometry.size = geometry.box.diagonal();
  for (Box3& box : geometry.leaf_boxes) box = box.inflated(kBoxInflation * geometry.size);
  for (AnalyticFace& face : geometry.analytic) face.box = face.box.inflated(kBoxInflation * geometry.size);
  geometry.box = geometry.box.inflated(kBoxInflation * geometry.size);
  return geometry;
}

std::size_t PartGeometry::bytes() const {
  std::size_t sum = leaves.size() * (sizeof(Leaf) + sizeof(LeafCurls)) + analytic.size() * sizeof(AnalyticFace) +
                    powers.size() * sizeof(double) + float_powers.size() * sizeof(float);
  for (const TrimRegion& trim : trims) sum += trim.bytes();
  for (const LeafPatch& p : patches) sum += sizeof(LeafPatch) + p.piece.patch.net.size() * sizeof(Vec4);
  return sum;
}

}  // namespace iso
