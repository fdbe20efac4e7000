// The film as an OpenEXR file: the only source that includes OpenEXR.
//
// One part, scan lines, ZIP. Unnamed R G B A in half, linear Rec. 709, premultiplied, never clamped below the largest half. Data layers in
// float: N.X N.Y N.Z (outward normal, world axes), P.X P.Y P.Z (world), Z (distance along the line of sight; infinite: nothing there),
// uv.u uv.v (the surface's parameters), id.instance id.face (-1: nothing there), and planes with names of their own. No time stamps:
// same picture, same bytes.
#pragma once

#include <string>

#include "patches/base/result.h"
#include "raytracer/film.h"

namespace iso {

// What the file says about itself, under "isophote/...".
struct ImageInfo {
  std::string version, mode = "direct", shade, units, scene_hash, comments;
  std::uint64_t seed = 0;
  int samples = 0;
  bool complete = true;
  Matrix44 world_to_camera{}, world_to_ndc{};
};

// The bytes of the file. Fails only if OpenEXR does.
Result<std::string> encode_exr(const Film& film, const ImageInfo& info, int threads);

}  // namespace iso
