#include "raytracer/camera.h"

namespace iso {
namespace {

constexpr double kMargin = 0.05;  // of the picture, left free on each side of a framed model

struct Orientation {
  Vec3 back, up;  // from the model to the viewer; upward in the picture
};

Orientation orientation_of(View view) {
  switch (view) {
    case View::iso:
      return {{1, -1, 0.8164965809277260}, {0, 0, 1}};  // 30 degrees above the horizon
    case View::front:
      return {{0, -1, 0}, {0, 0, 1}};
    case View::back:
      return {{0, 1, 0}, {0, 0, 1}};
    case View::left:
      return {{-1, 0, 0}, {0, 0, 1}};
    case View::right:
      return {{1, 0, 0}, {0, 0, 1}};
    case View::top:
      return {{0, 0, 1}, {0, 1, 0}};
    case View::bottom:
      return {{0, 0, -1}, {0, 1, 0}};
  }
  ISO_CHECK(!"a view");
}

void set_axes(Camera& camera, const Vec3& back, const Vec3& up) {
  camera.back = glm::normalize(back);
  camera.right = glm::normalize(glm::cross(up, camera.back));
  camera.up = glm::cross(camera.back, camera.right);
}

Vec3 in_camera(const Camera& camera, const Vec3& p) {
  const Vec3 v = p - camera.position;
  return {glm::dot(v, camera.right), glm::dot(v, camera.up), glm::dot(v, camera.back)};
}

template <class Use>
void each_corner(const Box3& box, const Use& use) {
  for (int i = 0; i < 8; ++i) use(Vec3{i & 1 ? box.hi.x : box.lo.x, i & 2 ? box.hi.y : box.lo.y, i & 4 ? box.hi.z : box.lo.z});
}

// With c = (x, y, z) the points in camera axes, the camera at (X, Y, D) sees all of them if x - X <= s (D - z) and X - x <= s (D - z),
// s the slope of the picture's side; likewise for y. The smallest D and the middle X, Y follow in closed form.
void frame_perspective(Camera& camera, std::span<const Vec3> points, double slope_x, double slope_y, double smallest) {
  double right = -kInf, left = -kInf, top = -kInf, bottom = -kInf, nearest = -kInf;
  for (const Vec3& point : points) {
    const Vec3 c = in_camera(camera, point);
    right = std::max(right, c.x + slope_x * c.z);
    left = std::max(left, -c.x + slope_x * c.z);
    top = std::max(top, c.y + slope_y * c.z);
    bottom = std::max(bottom, -c.y + slope_y * c.z);
    nearest = std::max(nearest, c.z);
  }
  const double distance = std::max({(right + left) / (2 * slope_x), (top + bottom) / (2 * slope_y), nearest + smallest});
  camera.position += 0.5 * (right - left) * camera.right + 0.5 * (top - bottom) * camera.up + distance * camera.back;
}

void frame_orthographic(Camera& camera, std::span<const Vec3> points, double aspect, double smallest) {
  Box3 box;
  for (const Vec3& point : points) box.include(in_camera(camera, point));
  const Vec3 size = box.size(), middle = box.middle();
  camera.half_height = std::max({0.5 * size.y, 0.5 * size.x / aspect, smallest}) / (1 - 2 * kMargin);
  camera.position += middle.x * camera.right + middle.y * camera.up + (box.hi.z + size.z + smallest) * camera.back;
}

}  // namespace

Ray camera_ray(const Camera& camera, const ImageSize& size, double x, double y) {
  // Plane coordinates: y runs over [-half_height, half_height], x has the same scale.
  const double scale = 2 * camera.half_height / size.height;
  const Vec3 offset = (x - 0.5 * size.width) * scale * camera.right + (0.5 * size.height - y) * scale * camera.up;
  if (camera.projection == Projection::orthographic) return {camera.position + offset, -camera.back};
  return {camera.position, glm::normalize(offset - camera.back)};
}

RayDifferential ray_differential(const Camera& camera, const ImageSize& size, const Ray& ray) {
  const double scale = 2 * camera.half_height / size.height;
  const Vec3 right = scale * camera.right, down = -scale * camera.up;
  if (camera.projection == Projection::orthographic) return {right, down, Vec3(0.0), Vec3(0.0)};
  // d = w / |w| for w with depth 1, so that 1 / |w| is the cosine to the line of sight.
  const double cosine = -glm::dot(ray.d, camera.back);
  const auto turned = [&](const Vec3& w) { return cosine * (w - glm::dot(w, ray.d) * ray.d); };
  return {Vec3(0.0), Vec3(0.0), turned(right), turned(down)};
}

std::optional<Camera> look_at(Projection projection, const Vec3& from, const Vec3& at, const Vec3& up, double extent) {
  // Directions are compared after scaling to unit length, so that neither the scene's size nor its place matters.
  const double distance = glm::length(from - at), length = glm::length(up);
  if (!(distance > 0) || !(length > 0) || !finite(distance) || !finite(length)) return {};
  const Vec3 back = (from - at) / distance, upward = up / length;
  constexpr double kParallel = 1e-9;  // radians; below it the picture's upright direction would be rounding noise
  if (!(glm::length(glm::cross(upward, back)) > kParallel)) return {};

  Camera camera{.projection = projection, .position = from};
  set_axes(camera, back, upward);
  camera.half_height = projection == Projection::perspective ? std::tan(0.5 * extent * kPi / 180) : 0.5 * extent;
  return camera;
}

Camera frame(std::span<const Vec3> points, View view, Projection projection, double fov_degrees, const ImageSize& size) {
  ISO_CHECK(!points.empty());
  const Orientation orientation = orientation_of(view);
  Box3 box;
  for (const Vec3& point : points) box.include(point);
  Camera camera{.projection = projection, .position = box.middle()};
  set_axes(camera, orientation.back, orientation.up);

  // A model without extent still gets a camera at some distance from it.
  const double diagonal = box.diagonal();
  const double smallest = diagonal > 0 ? 1e-3 * diagonal : 1;
  const double aspect = double(size.width) / size.height;
  if (projection == Projection::orthographic) {
    frame_orthographic(camera, points, aspect, smallest);
  } else {
    camera.half_height = std::tan(0.5 * fov_degrees * kPi / 180);
    const double slope = camera.half_height * (1 - 2 * kMargin);
    frame_perspective(camera, points, slope * aspect, slope, smallest);
  }
  return camera;
}

Range depth_range(const Camera& camera, const Box3& box) {
  Range depth;
  if (!box.empty()) each_corner(box, [&](const Vec3& p) { depth.include(-in_camera(camera, p).z); });
  if (depth.empty()) depth = {1, 2};
  // Behind the camera nothing is seen; a flat scene gets some thickness.
  const double reach = std::max({std::abs(depth.lo), std::abs(depth.hi), 1e-30});
  depth.lo = std::max(depth.lo, 1e-4 * reach);
  depth.hi = std::max(depth.hi, depth.lo * (1 + 1e-4));
  return depth;
}

Matrix44 world_to_camera(const Camera& camera) {
  const Vec3 t = in_camera(camera, Vec3(0.0));
  Matrix44 m{};
  for (int i = 0; i < 3; ++i) m[i] = {camera.right[i], camera.up[i], -camera.back[i], 0};
  m[3] = {t.x, t.y, -t.z, 1};
  return m;
}

Matrix44 world_to_ndc(const Camera& camera, const ImageSize& size, const Range& depth) {
  // Camera space to the unit square and depth to [0, 1]; after the division by w in perspective.
  const double aspect = double(size.width) / size.height, range = depth.hi - depth.lo;
  const double sx = 0.5 / (camera.half_height * aspect), sy = -0.5 / camera.half_height;
  Matrix44 projection{};
  projection[0][0] = sx;
  projection[1][1] = sy;
  if (camera.projection == Projection::perspective) {
    projection[2] = {0.5, 0.5, depth.hi / range, 1};
    projection[3] = {0, 0, -depth.hi * depth.lo / range, 0};
  } else {
    projection[2] = {0, 0, 1 / range, 0};
    projection[3] = {0.5, 0.5, -depth.lo / range, 1};
  }

  const Matrix44 view = world_to_camera(camera);
  Matrix44 product{};
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      for (int k = 0; k < 4; ++k) product[i][j] += view[i][k] * projection[k][j];
  return product;
}

std::optional<View> view_named(std::string_view name) {
  for (std::size_t i = 0; i < kViewNames.size(); ++i)
    if (name == kViewNames[i]) return static_cast<View>(i);
  return {};
}

}  // namespace iso
