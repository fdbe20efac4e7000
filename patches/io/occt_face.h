// Faces of Open CASCADE as ours: surface, trim loops in (u, v), and the edges that faces share.
#pragma once

#include <TopTools_DataMapOfShapeInteger.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <functional>
#include <string>

#include "patches/brep.h"

namespace iso::occt {

using Report = std::function<void(Problem::Kind, const std::string&)>;

// A part in the making, with the numbers of the edges seen so far.
struct PartInProgress {
  Part part;
  TopTools_DataMapOfShapeInteger edge_numbers;  // by TShape and location: the same edge elsewhere is another edge

  int edge_number(const TopoDS_Edge& edge);
};

// Adds the face (with its location baked in) to the part; false if it cannot be used. What was mended, approximated or dropped goes to
// `report`.
bool add_face(const TopoDS_Face& face, int solid, PartInProgress& part, const Report& report);

}  // namespace iso::occt
