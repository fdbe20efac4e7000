// Trim loops from a heap of parameter curves: order, direction, continuity across periods, nesting. Readers of formats whose wires may be
// unordered, wrongly directed or off by whole periods use it; it knows nothing of the formats.
#pragma once

#include <vector>

#include "patches/brep.h"

namespace iso {

// A trim curve with its ends in (u, v), and the number under which the caller knows it.
struct LoopPiece {
  TrimCurve trim;
  UV start{0.0}, end{0.0};
  int tag = -1;
};
LoopPiece loop_piece(TrimCurve trim, int tag);

struct Chain {
  std::vector<LoopPiece> pieces;  // each starts where the one before ends, as nearly as the file allows
  Vec2 winding{0.0};              // whole periods between the end and the start: not zero where the loop goes around the surface
  int turned = 0;                 // pieces whose direction in the file was wrong
};

// Orders pieces into closed chains. The order given is kept wherever it is continuous; `size` scales the two parameters.
std::vector<Chain> chains_of(std::vector<LoopPiece> pieces, const Vec2& period, const Vec2& size);

// Moves a chain by whole periods; turns it around.
void shift(Chain& chain, const Vec2& by);
void turn(Chain& chain);

// Where consecutive pieces do not meet: from the end of one to the start of the next.
struct Gap {
  UV from, to;
  int piece;  // the one before the gap
};
Gap gap_after(const Chain& chain, size_t i);

// Joints open by more than a small share of the loop's own box get a straight piece, so that everyone who walks the loop sees it; it has
// tag kClosingTag. Smaller ones (tolerances of the file) are left to the trim test.
inline constexpr int kClosingTag = -1;
void close_jumps(Chain& chain);

// Chains that go around a periodic surface (winding is not zero) bound a band in pairs: each pair becomes one closed chain with two
// straight pieces in between, the same line one period apart, run to and fro. Seams have tags -2, -3, ...: both pieces of a seam have the
// same one. A partner lies on the material's side (left of the direction), or anywhere.
enum class Partner { on_material_side, anywhere };
void join_bands(std::vector<Chain>& chains, const Vec2& period, Partner partner, int& next_seam);

// Where the material lies of a chain that goes around: the parameter across its direction, and the sign.
struct Side {
  int across;
  double sign;
};
Side material_side(const Chain& chain);

// Closes a chain that goes around by a seam to the line where the parameter across is `value` (a pole, an apex, an end), along it, and
// back.
void close_at(Chain& chain, double value, int& next_seam);

// The outline of a box as a counter-clockwise chain; sides one period apart are a seam.
Chain outline_of(const Box2& box, const Vec2& period, int& next_seam);

// Points along a chain, the first not repeated at the end.
std::vector<UV> polygon_of(const Chain& chain);
double signed_area(const std::vector<UV>& polygon);

// Puts the chain with the largest area near `natural`, and every other one into its window of periods.
void align_periods(std::vector<Chain>& chains, const Vec2& period, const Box2& natural);

// Chains that enclose material run counter-clockwise, holes clockwise. Returns which chains run the other way (nothing is changed).
std::vector<size_t> wrongly_directed(const std::vector<Chain>& chains);

// A box that holds the trim curves; near to the smallest.
Box2 box_of(const std::vector<Chain>& chains);

}  // namespace iso
