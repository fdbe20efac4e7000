// Which edges of a face's mesh lie on a border that the model leaves free: on an edge used by one face only, on a trim curve of no edge, or
// on the side of an untrimmed domain that does not close.
#pragma once

#include <cstdint>
#include <set>
#include <span>
#include <utility>

#include "patches/brep.h"
#include "patches/triangle_mesh.h"

namespace iso {

// A node counts as on the border within this, relative to the size of the face's domain: far above the rounding of a curve's evaluation,
// far below any triangle's size.
inline constexpr double kOnBorder = 1e-9;

// Pairs (smaller first) of neighbours along the free borders among `nodes`; as indices into `nodes`.
using NodePairs = std::set<std::pair<std::uint32_t, std::uint32_t>>;
NodePairs free_neighbours(const Face& face, std::span<const Edge> edges, std::span<const MeshNode> nodes);

}  // namespace iso
