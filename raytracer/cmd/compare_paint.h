// Numbers and triangles as colours: integrators for the pictures of a comparison, and what becomes of their films.
#pragma once

#include "raytracer/cmd/compare_report.h"
#include "raytracer/colour_scale.h"
#include "raytracer/film.h"
#include "raytracer/shading.h"

namespace iso {

// A number for a point of an exact face and its outward normal there, in world coordinates; NaN: not known. Called from many threads at
// once.
using SurfaceField = std::function<double(const Point3& point, const Vec3& normal, std::int32_t placed, std::int32_t face)>;

// Paints the field at exact hits, evaluated in double: red holds the number, green 1 where it is known. The film's values are sums over
// samples, so that `field_values` gives means.
Integrator painted_field(const Tracer& tracer, const SurfaceField& field);

// The mean curvature of the exact surface at its hits, likewise; 1 / world unit.
Integrator painted_mean_curvature(const Tracer& tracer);

// The mean of what is known in each pixel; NaN where nothing is.
std::vector<double> field_values(const Film& film);

// The triangles of meshes as they are, lit from the eye, with faint edges where they are large enough to be told apart; exact parts
// likewise without edges. Both sides alike.
Integrator facets(const Tracer& tracer, const Camera& camera, const ImageSize& size);

Colour scale_colour(const ReportLegend& legend, double value);  // display-encoded; ends are held; grey for NaN

// Values as colours of a scale, display-encoded, covered as `alpha`.
Image scale_picture(const std::vector<double>& values, const Image& alpha, const ReportLegend& legend);

// Covered (alpha over half) in the exact picture only, in the mesh's only, in both: blue, orange and grey, which the colour-blind tell
// apart. Display-encoded; clear where neither is.
ReportLegend silhouette_legend();
Image silhouette_picture(const Image& exact, const Image& mesh);

// Code values over black, mesh less exact, around grey.
struct DifferencePicture {
  Image picture;
  double gain = 1;  // a power of two: so that 99 % of the pixels that differ stay within black and white
};
DifferencePicture difference_picture(const Image& exact, const Image& mesh);

}  // namespace iso
