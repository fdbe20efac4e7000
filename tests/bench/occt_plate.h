// A machined part of analytic faces only.
#pragma once

#include <string>

namespace iso::bench {

// Writes a BREP file: a plate with 5 x 5 blind holes and a loose pin in each, its head flat, a cone, or a dome: 72 planes, 50 cylinders,
// 8 cones, 9 spheres. Throws std::runtime_error where Open CASCADE fails.
void write_plate_with_pins(const std::string& path);

}  // namespace iso::bench
