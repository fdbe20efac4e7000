// Cameras: perspective and orthographic, and the framing of points for a scene that comes without one.
//
// Camera space is right-handed: x right, y up, looking along -z. Pixel coordinates run from (0, 0) at the picture's upper left corner to
// (width, height); pixels are square. The vertical field of view (or the height, orthographic) belongs to the whole picture.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string_view>

#include "raytracer/tracer.h"

namespace iso {

enum class Projection { perspective, orthographic };
enum class View { iso, front, back, left, right, top, bottom };

inline constexpr double kDefaultFov = 28;  // degrees, vertical: a long lens, little distortion
inline constexpr double kMinFov = 0.01, kMaxFov = 170;

struct ImageSize {
  int width = 1280, height = 960;
};

struct Camera {
  Projection projection = Projection::perspective;
  Vec3 position{0.0};
  Vec3 right{1, 0, 0}, up{0, 1, 0}, back{0, 0, 1};  // orthonormal
  double half_height = 0.25;                        // perspective: tan(fov / 2); orthographic: half the visible height, world units
};

// The ray through pixel coordinates (x, y); unit direction.
Ray camera_ray(const Camera& camera, const ImageSize& size, double x, double y);

// How the ray through a point of the picture changes per pixel to the right (x) and down (y).  [Igehy 1999, 2.1]
struct RayDifferential {
  Vec3 o_x{0.0}, o_y{0.0}, d_x{0.0}, d_y{0.0};
};
// Of a ray that camera_ray made.
RayDifferential ray_differential(const Camera& camera, const ImageSize& size, const Ray& ray);

// A camera at `from` that looks at `at`. Nothing if the points coincide or `up` is parallel to the line of sight.
// `extent`: degrees of vertical field of view, or visible height.
std::optional<Camera> look_at(Projection projection, const Vec3& from, const Vec3& at, const Vec3& up, double extent);

// The camera that just holds all points with a margin, seen from a named direction; z is up, `front` looks along +y. At least one point.
Camera frame(std::span<const Vec3> points, View view, Projection projection, double fov_degrees, const ImageSize& size);

// Smallest and largest distance along the line of sight of the scene's box; positive, lo < hi.
Range depth_range(const Camera& camera, const Box3& box);

// Row-major matrices for row vectors (p' = p M), as the OpenEXR standard attributes define them: camera space is left-handed there, x
// right, y up, looking along +z; NDC runs from (0, 0) at the upper left to (1, 1) at the lower right corner, z from 0 (near) to 1 (far).
using Matrix44 = std::array<std::array<double, 4>, 4>;
Matrix44 world_to_camera(const Camera& camera);
Matrix44 world_to_ndc(const Camera& camera, const ImageSize& size, const Range& depth);

std::optional<View> view_named(std::string_view name);
inline constexpr std::array<const char*, 7> kViewNames{"iso", "front", "back", "left", "right", "top", "bottom"};

}  // namespace iso
