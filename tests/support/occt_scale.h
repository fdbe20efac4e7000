// CAD files with their geometry rewritten, made by Open CASCADE alone.
#pragma once

#include <string>

namespace iso::test {

// Reads a STEP or BREP file, scales every curve, surface and point by `factor` about the origin, and writes a STEP file in millimetres.
// Returns what went wrong, or nothing (empty).
std::string write_scaled_step(const std::string& from, double factor, const std::string& to);

}  // namespace iso::test
