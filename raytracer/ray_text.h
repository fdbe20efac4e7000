// Rays and hits as text, for `isophote hit`.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "patches/base/result.h"
#include "raytracer/tracer.h"

namespace iso {

// Whether a line carries no ray: blank, or a comment that begins with '#'.
bool is_skipped(std::string_view line);

// "ox oy oz dx dy dz", separated by blanks. The error has no file and no place: the caller knows them.
Result<Ray> parse_ray(std::string_view line);

enum class HitFormat { text, json };

// One line, newline included. `ray` is the 0-based number of the input line. Text:
//   ray t x y z nx ny nz u v k1 k2 instance face name        seventeen digits; nan where a curvature does not exist
// JSON: {"ray", "t", "p", "n", "uv", "k", "instance", "face", "name"}, null for what does not exist.
void append_hit(std::string& out, HitFormat format, std::uint64_t ray, const Tracer& tracer, const Hit& hit);

// "ray miss", or {"ray": n, "miss": true}.
void append_miss(std::string& out, HitFormat format, std::uint64_t ray);

}  // namespace iso
