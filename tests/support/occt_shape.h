// A CAD file as Open CASCADE's plain readers see it; for files that include Open CASCADE.
#pragma once

#include <TopoDS_Shape.hxx>
#include <string>

#include "tests/support/occt_mesh.h"

namespace iso::test {

// In mm for STEP and IGES, else in the file's unit; without the mesh that a BREP file may bring along. Throws OcctFailure.
TopoDS_Shape read_occt_shape(const std::string& path);

}  // namespace iso::test
