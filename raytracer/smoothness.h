// Shades that show how smooth exact surfaces are: stripes (stripes.h), and mean or Gaussian curvature in false colours.
//
// Stripes are filtered per ray, over a part of the pixel: the shape operator of the exact surface and the ray's differential
// [Igehy 1999] give how far the phase goes within it, so that one sample per pixel has clean lines. Borders of faces and silhouettes are
// not filtered that way; more samples smooth them too. On a mesh the normals are its own, and so is their turning where it is flat (none);
// where it is smooth, the exact surface's at (u, v) stands in. At singular points, where no normal turns, only the view's own change is
// filtered; where there is no normal at all, the mean of the stripes is shown.
//
// Curvatures are those of the exact surface, of a mesh too; at singular points they are undefined (yellow).
#pragma once

#include "raytracer/camera.h"
#include "raytracer/colour_scale.h"
#include "raytracer/shading.h"
#include "raytracer/stripes.h"

namespace iso {

bool has_stripes(Shade shade);  // zebra, reflection-lines, isophotes
bool has_scale(Shade shade);    // mean-curvature, gauss-curvature

// What may be asked of these shades; empty members take the defaults.
struct ShadeOptions {
  std::optional<Vec3> direction;     // stripes: unit, in world coordinates
  std::optional<int> lines;          // stripes: 1 ... kMaxLines
  std::optional<double> line_width;  // stripes: in (0, 1)
  std::optional<Range> range;        // scale: finite, lo < hi; per world unit (mean) or square world unit (Gauss)
  std::optional<bool> legend;        // scale: whether it is drawn into the picture
};

enum class ShadeOption { direction, lines, line_width, range, legend };

// The first of the options given that means nothing to the shade.
std::optional<ShadeOption> meaningless_option(const ShadeOptions& options, Shade shade);

// The names of the shades that have an option, for messages.
const char* shades_with(ShadeOption option);

// Those that are not given: 12 zebra bands to half a turn and 36 reflection lines all round, both along the camera's horizontal, and 12
// isophotes about the direction of the default key light; lines a quarter of their period wide, bands half.
Stripes stripes_for(Shade shade, const ShadeOptions& options, const Camera& camera);

struct StripeView {
  Camera camera;
  ImageSize size;
  int samples = 1;  // per pixel
};

// The picture's filter is made of two: the samples' own windows, which have 1 / sqrt(samples) of its variance, and where samples lie, which
// has the rest. So one sample lies in the pixel's middle and stands for all of it, and many come to what points would show.
Integrator stripes(const Tracer& tracer, const Stripes& stripes, const StripeView& view);

// How far samples are spread, for RenderSettings.
double stripe_spread(int samples);

// The normal at a hit of `ray`, and how it changes per pixel. No derivatives where they are not finite.
SeenNormal seen_normal(const Tracer& tracer, const Ray& ray, const Hit& hit, const RayDifferential& differential);

// What the picture shows: the mean curvature -(k1 + k2) / 2, positive where the face bulges outward, or the Gaussian curvature k1 k2.
// k1, k2 as in Curvatures, about the outward normal.
double curvature_value(Shade shade, const Curvatures& k);

Integrator curvature_map(const Tracer& tracer, Shade shade, const ColourScale& scale);

// A range for the picture, symmetric about 0: its end is the smallest 1, 2 or 5 times a power of ten that 95 % of the curved places do not
// exceed, of 128 x 96 rays spread evenly over the picture. So it depends on what is in view, not on pixels or samples. Where nothing is
// curved it is that of a sphere as large as the scene.
Range automatic_range(const Tracer& tracer, const Camera& camera, const ImageSize& size, Shade shade);

}  // namespace iso
