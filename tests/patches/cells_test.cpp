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
      grid{"cells on the grid of 2^-12", kSeed};
  std::uint64_t cells = 0, pieces = 0;
  double stray_use = 0;
};

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
      const Vec2 ab = k < 4 ? Vec2(k & 1 ? 1 : -1, k & 2 ? 1 : -1) : random_vector<Vec2>(random, 1);
      const Slopes s = slopes_at(piece, cell, ab);
      const double rounding = 1e-13 * size;
      t.strays.check(glm::length(s.a - cell.A) <= cell.stray_a + rounding && glm::length(s.b - cell.B) <= cell.stray_b + rounding, [&] {
        return fmt::format("{}: strays {} and {}, bounds {} and {}", c.name, glm::length(s.a - cell.A), glm::length(s.b - cell.B),
                           cell.stray_a, cell.stray_b);
      });
      t.boxes.check(cell.box.inflated(1e-14 * size).contains(s.S), [&] { return c.name + ": a sample outside the cell's box"; });
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
  t.area.finish(t.pieces);
  t.once.finish(t.pieces * 20);
  t.strays.finish(t.cells * 6);
  t.boxes.finish(t.cells * 6);
  t.grid.finish(t.cells);
  EXPECT_GE(t.pieces, 100u);
  EXPECT_GE(t.cells, 10000u);
  fmt::print("[ measured ] {} pieces, {} cells; largest used share of a stray bound {:.3g}\n", t.pieces, t.cells, t.stray_use);
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
        const double cross = glm::length(glm::cross(cell.A, cell.B));
        kept += (cell.stray_a * glm::length(cell.B) + cell.stray_b * glm::length(cell.A)) / cross <= policy.bend ? 1 : 0;
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
