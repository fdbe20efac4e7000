// The division of faces into cells: a partition, with honest bounds.
#include "patches/cells.h"

#include "tests/support/random_shapes.h"
#include "tests/support/tally.h"

namespace iso::test {
namespace {

constexpr std::uint64_t kSeed = 20240610;

// dS/da and dS/db at (a, b) of a cell, by the homogeneous jet of its piece.
struct Slopes {
  Vec3 S, a, b;
};
Slopes slopes_at(const BezierPiece& piece, const FaceCell& cell, const Vec2& ab) {
  const Vec2 half = 0.5 * (cell.hi - cell.lo);
  const HomogeneousJet j = homogeneous_jet(piece.patch, 0.5 * (cell.lo + cell.hi) + half * ab);
  const Vec3 S = project(j.H);
  return {S, half.x * (Vec3(j.Hs) - j.Hs.w * S) / j.H.w, half.y * (Vec3(j.Ht) - j.Ht.w * S) / j.H.w};
}

struct CellTallies {
  Tally area{"areas", kSeed}, strays{"strays", kSeed}, boxes{"boxes", kSeed}, once{"every point in one cell", kSeed},
      grid{"cells on the grid of 2^-12", kSeed}, slabs{"slabs", kSeed}, tilts{"tilts", kSeed}, curls{"curls", kSeed};
  std::uint64_t cells = 0, pieces = 0, tilted = 0;
  double stray_use = 0;
};

// At a sample, for a ray that is just steep enough: what Newton's map adds to the identity is smaller than 1 in the spectral norm. Here by
// the cross products that define the two-plane form, not by the slab's rows.
void check_tilt(Random& random, const std::string& name, const FaceCell& cell, const Slopes& s, double rounding, CellTallies& t) {
  if (!finite(cell.tilt)) return;
  const Vec3 n = cell.slab.row[2], along = cell.A * between(random, -1, 1) + cell.B * between(random, -1, 1);
  const Vec3 d = along + 1.001 * cell.tilt * glm::length(along) * n;
  const double volume = glm::dot(d, glm::cross(cell.A, cell.B));
  const auto parameters = [&](const Vec3& v) {  // of v, moved along d into the tangent plane
    return Vec2(glm::dot(d, glm::cross(v, cell.B)), glm::dot(d, glm::cross(cell.A, v))) / volume;
  };
  // The columns of the map in the tangent plane: images of two unit vectors at right angles.
  const Vec3 e1 = glm::normalize(cell.A), e2 = glm::cross(n, e1);
  const auto image = [&](const Vec3& e) {
    const Vec2 ab{glm::dot(n, glm::cross(e, cell.B)), glm::dot(n, glm::cross(cell.A, e))};
    const Vec2 moved = parameters(ab.x * (s.a - cell.A) + ab.y * (s.b - cell.B)) / glm::dot(n, glm::cross(cell.A, cell.B));
    const Vec3 v = moved.x * cell.A + moved.y * cell.B;
    return Vec2(glm::dot(v, e1), glm::dot(v, e2));
  };
  const Vec2 a = image(e1), b = image(e2);
  const double trace = glm::dot(a, a) + glm::dot(b, b), det = a.x * b.y - a.y * b.x;
  const double norm = std::sqrt(0.5 * trace + std::sqrt(std::max(0.0, 0.25 * trace * trace - det * det)));
  const double noise = rounding * glm::length(d) * (glm::length(cell.A) + glm::length(cell.B)) / std::abs(volume);
  if (!(noise < 0.01)) return;
  ++t.tilted;
  t.tilts.check(norm <= 1 + noise, [&] { return fmt::format("{}: norm {} of the map for a ray that should be sure", name, norm); });
}

// A plane through a point of the slab: its equation strays from its linear model by no more than the curls allow.
void check_curls(Random& random, const std::string& name, const BezierPiece& piece, const FaceCell& cell, const Vec2& ab, double size,
                 CellTallies& t) {
  const Vec2 middle = 0.5 * (cell.lo + cell.hi), half = 0.5 * (cell.hi - cell.lo);
  const HomogeneousJet j0 = homogeneous_jet(piece.patch, middle), j = homogeneous_jet(piece.patch, middle + half * ab);
  const Vec3 n = glm::normalize(random_vector<Vec3>(random, 1) + Vec3(0, 0, 1e-3));
  const double offset = glm::dot(n, slopes_at(piece, cell, random_vector<Vec2>(random, 0.5)).S);
  const auto f = [&](const Vec4& h) { return glm::dot(n, Vec3(h)) - offset * h.w; };
  const double stray = std::abs(f(j.H) - f(j0.H) - half.x * ab.x * f(j0.Hs) - half.y * ab.y * f(j0.Ht));
  const Vec2 r = glm::abs(ab);
  const double bound = 0.5 * cell.curls.x * r.x * r.x + cell.curls.y * r.x * r.y + 0.5 * cell.curls.z * r.y * r.y;
  t.curls.check(stray <= bound + 1e-13 * size, [&] { return fmt::format("{}: strays {} where {} is allowed", name, stray, bound); });
}

void examine(Random& random, const SurfaceCase& c, const BezierPiece& piece, const std::vector<FaceCell>& cells, CellTallies& t) {
  ++t.pieces;
  t.cells += cells.size();
  const double size = glm::length(glm::max(glm::abs(hull_box(piece.patch).lo), glm::abs(hull_box(piece.patch).hi)));
  double area = 0;
  for (const FaceCell& cell : cells) {
    area += (cell.hi.x - cell.lo.x) * (cell.hi.y - cell.lo.y);
    const Vec2 units = 4096.0 * (cell.hi - cell.lo), corner = 4096.0 * cell.lo;
    t.grid.check(units.x >= 1 && units.y >= 1 && units == glm::floor(units) && corner == glm::floor(corner),
                 [&] { return fmt::format("{}: a cell of {} x {} units at ({}, {})", c.name, units.x, units.y, corner.x, corner.y); });
    for (int k = 0; k < 6; ++k) {
      const Vec2 ab = kCellMargin * (k < 4 ? Vec2(k & 1 ? 1 : -1, k & 2 ? 1 : -1) : random_vector<Vec2>(random, 1));
      const Slopes s = slopes_at(piece, cell, ab);
      const double rounding = 1e-13 * size;
      t.strays.check(glm::length(s.a - cell.A) <= cell.stray_a + rounding && glm::length(s.b - cell.B) <= cell.stray_b + rounding, [&] {
        return fmt::format("{}: strays {} and {}, bounds {} and {}", c.name, glm::length(s.a - cell.A), glm::length(s.b - cell.B),
                           cell.stray_a, cell.stray_b);
      });
      const Vec3 inside = slopes_at(piece, cell, ab / kCellMargin).S;
      t.boxes.check(cell.box.inflated(1e-14 * size).contains(inside), [&] { return c.name + ": a sample outside the cell's box"; });
      for (int row = 0; row < 3; ++row) {
        const double at = glm::dot(cell.slab.row[row], inside - cell.centre), slack = rounding * glm::length(cell.slab.row[row]);
        t.slabs.check(cell.slab.reach[row].lo - slack <= at && at <= cell.slab.reach[row].hi + slack,
                      [&] { return fmt::format("{}: {} along row {} of the slab", c.name, at, row); });
      }
      check_tilt(random, c.name, cell, s, rounding, t);
      check_curls(random, c.name, piece, cell, ab, size, t);
      if (cell.stray_a > rounding) t.stray_use = std::max(t.stray_use, glm::length(s.a - cell.A) / cell.stray_a);
    }
  }
  // Dyadic areas add up without rounding, so exactly one means: no gap that is not made up by an overlap; the samples exclude that.
  t.area.check(area == 1, [&] { return fmt::format("{}: the cells' areas add up to {:.17g}", c.name, area); });
  for (int k = 0; k < 20; ++k) {
    const Vec2 st{between(random, 0, 1), between(random, 0, 1)};
    int holders = 0;
    for (const FaceCell& cell : cells) holders += cell.lo.x < st.x && st.x < cell.hi.x && cell.lo.y < st.y && st.y < cell.hi.y;
    t.once.check(holders == 1, [&] { return fmt::format("{}: ({}, {}) lies in {} cells", c.name, st.x, st.y, holders); });
  }
}

void finish(CellTallies& t) {
  t.area.finish(t.pieces);
  t.once.finish(t.pieces * 20);
  t.strays.finish(t.cells * 6);
  t.boxes.finish(t.cells * 6);
  t.grid.finish(t.cells);
  t.slabs.finish(t.cells * 18);
  t.curls.finish(t.cells * 6);
  t.tilts.finish(t.tilted);
}

TEST(Cells, PartitionEveryKindWithHonestBounds) {
  Random random(kSeed);
  CellTallies t;
  for (int round = 0; round < 2; ++round)
    for (const SurfaceCase& c : random_surfaces(random)) {
      CellPolicy policy;
      policy.small = 1e-3 * bounds(c.surface, c.uv).diagonal();
      policy.most_levels = round == 0 ? 18 : 8;
      for (const BezierPiece& piece : bezier_pieces(c.surface, c.uv)) {
        if (t.pieces > 60 && whole(random, 0, 9) > 0) continue;  // random surfaces have many pieces: a tenth will do
        std::vector<FaceCell> cells;
        divide(piece, 7, TrimRegion{}, policy, cells);
        examine(random, c, piece, cells, t);
        ASSERT_FALSE(cells.empty());
        EXPECT_EQ(cells.front().piece, 7);
      }
    }
  finish(t);
  EXPECT_GE(t.tilted, 3 * t.cells);
  EXPECT_GE(t.pieces, 100u);
  EXPECT_GE(t.cells, 10000u);
  fmt::print("[ measured ] {} pieces, {} cells; largest used share of a stray bound {:.3g}\n", t.pieces, t.cells, t.stray_use);
}

// A graph over the unit square with waves and noise, of any degree and with weights in [1, 1 + spread].
BezierPiece wavy_piece(Random& random, int pu, int pv, double spread) {
  BezierPiece piece;
  piece.patch.pu = pu;
  piece.patch.pv = pv;
  for (int i = 0; i <= pu; ++i)
    for (int j = 0; j <= pv; ++j) {
      const double x = static_cast<double>(i) / pu, y = static_cast<double>(j) / pv;
      const Vec3 p = Vec3(x, y, 0.3 * std::sin(4 * x) * std::cos(3 * y)) + random_vector<Vec3>(random, 0.02);
      piece.patch.net.push_back(homogeneous(p, 1 + spread * between(random, 0, 1)));
    }
  return piece;
}

// Above degree three bounds go by way of a cubic.
TEST(Cells, HighDegreesHaveHonestBounds) {
  Random random(kSeed + 3);
  CellTallies t;
  for (int round = 0; round < 40; ++round) {
    const BezierPiece piece = wavy_piece(random, whole(random, 1, 12), whole(random, 4, 12), round % 4 ? 0.4 : 1e-3);
    std::vector<FaceCell> cells;
    divide(piece, 0, TrimRegion{}, {}, cells);
    examine(random, {"a rational patch of high degree", Plane{}, {{0, 0}, {1, 1}}}, piece, cells, t);
  }
  finish(t);
  fmt::print("[ measured ] {} pieces, {} cells; largest used share of a stray bound {:.3g}\n", t.pieces, t.cells, t.stray_use);
}

// A face that is a line to rounding, with weights that differ in their last bits, as hammer.iges has some: rounding decides nothing.
TEST(Cells, AFaceWithoutWidthIsCutAlongItsLengthOnly) {
  BezierPiece piece;
  piece.patch.pu = piece.patch.pv = 2;
  const double weights[] = {0.99999999999999178, 0.99999999999999589, 1};
  const Vec3 corners[] = {{-6456.9, 1604.9, 17182.2}, {-6456.9, 1604.9, 18676.7}, {-6456.9, 110.5, 18676.7}};
  for (const double w : weights)
    for (int j = 0; j <= 2; ++j) piece.patch.net.push_back(homogeneous(corners[j], j == 1 ? 0.707106781 * w : w));
  CellPolicy policy;
  policy.small = 41;
  std::vector<FaceCell> cells;
  divide(piece, 0, TrimRegion{}, policy, cells);
  for (const FaceCell& cell : cells) {
    EXPECT_EQ(cell.hi.x - cell.lo.x, 1);
    EXPECT_EQ(cell.tilt, kInf);
  }
  EXPECT_LE(cells.size(), 128u);
}

// A smooth piece at the default policy ends with cells that keep it: the certificate holds for head-on rays nearly everywhere.
TEST(Cells, SmoothPiecesKeepThePolicy) {
  Random random(kSeed + 1);
  int kept = 0, all = 0;
  for (int i = 0; i < 20; ++i) {
    const Torus torus{random_frame(random), between(random, 2, 4), between(random, 0.3, 1)};
    for (const BezierPiece& piece : bezier_pieces(torus, natural_domain(torus))) {
      CellPolicy policy;
      std::vector<FaceCell> cells;
      divide(piece, 0, TrimRegion{}, policy, cells);
      for (const FaceCell& cell : cells) {
        ++all;
        kept += cell.tilt <= policy.bend ? 1 : 0;
      }
    }
  }
  EXPECT_EQ(kept, all);
  EXPECT_GE(all, 20 * 16);
}

// ---- with trim loops ---------------------------------------------------------------------------------------------------

TrimLoop circle_loop(const UV& centre, double r) { return {{{Ellipse<Vec2>{centre, {r, 0}, {0, r}}, 0, kTwoPi, -1}}}; }

TEST(Cells, AgreeWithTheTrimLoops) {
  Random random(kSeed + 2);
  Tally inside("cells inside", kSeed + 2), outside("points outside", kSeed + 2), covered("points inside are covered", kSeed + 2);
  std::uint64_t inside_cells = 0, out = 0, in = 0;
  for (int i = 0; i < 30; ++i) {
    const NurbsSurface s = random_nurbs(random, Knots::smooth, Knots::smooth, whole(random, 2, 4), whole(random, 2, 4), i % 2 == 0);
    Face face;
    face.surface = s;
    face.domain = natural_domain(s);
    const double r = 0.4 * std::min(face.domain.size().x, face.domain.size().y);
    face.loops = {circle_loop(face.domain.middle(), r), circle_loop(face.domain.middle() + Vec2(0.2 * r, 0), 0.3 * r)};
    const TrimRegion trim(face, {}, 0);
    const auto pieces = bezier_pieces(s, face.domain);
    std::vector<FaceCell> cells;
    for (std::size_t p = 0; p < pieces.size(); ++p) divide(pieces[p], static_cast<int>(p), trim, {}, cells);
    for (const FaceCell& cell : cells) {
      if (cell.kind != TrimRegion::Kind::inside) continue;
      ++inside_cells;
      const BezierPiece& piece = pieces[static_cast<std::size_t>(cell.piece)];
      for (int k = 0; k < 4; ++k) {
        const UV uv = piece.to_native({between(random, cell.lo.x, cell.hi.x), between(random, cell.lo.y, cell.hi.y)});
        inside.check(trim.contains(uv, s).inside, [&] { return fmt::format("({}, {}) is not inside", uv.x, uv.y); });
      }
    }
    for (int k = 0; k < 500; ++k) {
      const auto& piece = pieces[static_cast<std::size_t>(whole(random, 0, static_cast<int>(pieces.size()) - 1))];
      const Vec2 st{between(random, 0, 1), between(random, 0, 1)};
      bool held = false, held_whole = false;
      for (const FaceCell& cell : cells)
        if (&pieces[static_cast<std::size_t>(cell.piece)] == &piece && Box2{cell.lo, cell.hi}.contains(st)) {
          held = true;
          held_whole = held_whole || cell.kind == TrimRegion::Kind::inside;
        }
      if (trim.contains(piece.to_native(st), s).inside) {
        ++in;
        covered.check(held, [&] { return std::string("a point of the face is in no cell"); });
      } else {
        ++out;
        outside.check(!held_whole, [&] { return std::string("a point outside the loops is in a cell that is wholly inside"); });
      }
    }
  }
  EXPECT_GE(inside_cells, 500u);
  EXPECT_GE(in, 3000u);
  inside.finish(inside_cells * 4);
  covered.finish(in);
  outside.finish(out);
}

}  // namespace
}  // namespace iso::test
