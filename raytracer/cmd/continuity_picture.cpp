#include "raytracer/cmd/continuity_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "raytracer/colour_scale.h"
#include "raytracer/srgb.h"

namespace iso {
namespace {

constexpr double kDegrees = 180 / kPi;

// Rays end so much of the scene's diagonal before the edge: the faces beside it are not in its way.
constexpr double kInFront = 1e-3;

// A place of an edge in the picture.
struct PicturePlace {
  Vec2 at{0.0};       // pixels
  bool seen = false;  // before the camera
};

PicturePlace project(const Camera& camera, const ImageSize& size, const Point3& p) {
  const Vec3 v = p - camera.position;
  const double depth = -glm::dot(v, camera.back), per_unit = size.height / (2 * camera.half_height);
  const double scale = camera.projection == Projection::perspective ? per_unit / depth : per_unit;
  return {{0.5 * size.width + scale * glm::dot(v, camera.right), 0.5 * size.height - scale * glm::dot(v, camera.up)}, depth > 0};
}

// A short piece of a line, of one colour.
struct Stroke {
  Vec2 a{0.0}, b{0.0};
  Point3 middle{0.0};
  Colour colour{0.0f};
  double rank = 0;  // the higher lies on top
};

// Strokes of one pixel or less along the samples of one edge; those out of the picture are left out.
class EdgeStrokes {
 public:
  EdgeStrokes(const Camera& camera, const ImageSize& size, std::vector<Stroke>& strokes) : camera_(camera), size_(size), out_(strokes) {}

  template <class Paint>
  void add(const Point3& from, double value_from, const Point3& to, double value_to, const Paint& paint) {
    constexpr int kMost = 1 << 14;
    const PicturePlace a = project(camera_, size_, from), b = project(camera_, size_, to);
    if (!a.seen || !b.seen) return;
    const int parts = static_cast<int>(std::clamp(std::ceil(glm::length(b.at - a.at)), 1.0, double(kMost)));
    for (int i = 0; i < parts; ++i) {
      const auto at = [&](double s) { return project(camera_, size_, from + s * (to - from)).at; };
      const double s = (i + 0.5) / parts;
      Stroke stroke{at(double(i) / parts), at(double(i + 1) / parts), from + s * (to - from)};
      if (!inside(stroke.a) && !inside(stroke.b)) continue;
      paint(value_from + s * (value_to - value_from), stroke);
      out_.push_back(stroke);
    }
  }

 private:
  bool inside(const Vec2& p) const {
    return -kLineWidth <= p.x && p.x <= size_.width + kLineWidth && -kLineWidth <= p.y && p.y <= size_.height + kLineWidth;
  }
  const Camera& camera_;
  const ImageSize& size_;
  std::vector<Stroke>& out_;
};

// Drops the strokes that something stands before.
void drop_hidden(std::vector<Stroke>& strokes, const Tracer& tracer, const Camera& camera, const ImageSize& size) {
  const double margin = kInFront * tracer.scene().box().diagonal();
  std::vector<Ray> rays;
  for (const Stroke& stroke : strokes) {
    const Vec2 pixel = project(camera, size, stroke.middle).at;
    Ray ray = camera_ray(camera, size, pixel.x, pixel.y);
    ray.tmax = std::max(0.0, glm::dot(stroke.middle - ray.o, ray.d) - margin);
    rays.push_back(ray);
  }
  std::vector<std::uint8_t> blocked(rays.size());
  SolverStats stats;
  tracer.occluded(rays, blocked, Tracer::Order::coherent, stats);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < strokes.size(); ++i)
    if (!blocked[i]) strokes[kept++] = strokes[i];
  strokes.resize(kept);
}

// How much of a pixel at this distance from the middle of a line it covers.
double coverage(double distance) { return std::clamp(0.5 * kLineWidth + 0.5 - distance, 0.0, 1.0); }

// All strokes over the picture: in each pixel the one that covers most of it, of equals the higher rank.
void paint_strokes(std::vector<glm::vec4>& rgba, const std::vector<Stroke>& strokes, const ImageSize& size) {
  struct Cover {
    double covered = 0, rank = 0;
    Colour colour{0.0f};
  };
  std::vector<Cover> covers(rgba.size());
  const auto clamped = [](double x, int most) { return static_cast<int>(std::clamp(x, 0.0, double(most - 1))); };
  for (const Stroke& s : strokes) {
    const Vec2 lo = glm::min(s.a, s.b) - Vec2(kLineWidth), hi = glm::max(s.a, s.b) + Vec2(kLineWidth), along = s.b - s.a;
    const double length2 = glm::dot(along, along);
    for (int y = clamped(lo.y, size.height); y <= clamped(hi.y, size.height); ++y)
      for (int x = clamped(lo.x, size.width); x <= clamped(hi.x, size.width); ++x) {
        const Vec2 p = Vec2(x + 0.5, y + 0.5) - s.a;
        const double share = length2 > 0 ? std::clamp(glm::dot(p, along) / length2, 0.0, 1.0) : 0.0;
        const double covered = coverage(glm::length(p - share * along));
        Cover& cover = covers[static_cast<std::size_t>(y) * static_cast<std::size_t>(size.width) + static_cast<std::size_t>(x)];
        if (covered > cover.covered || (covered > 0 && covered == cover.covered && s.rank > cover.rank))
          cover = {covered, s.rank, s.colour};
      }
  }
  for (std::size_t i = 0; i < rgba.size(); ++i)
    if (covers[i].covered > 0) rgba[i] = glm::mix(rgba[i], glm::vec4(covers[i].colour, 1.0f), static_cast<float>(covers[i].covered));
}

// Colour and rank of a place of an edge.
struct EdgePainter {
  const EdgeContinuity& edge;
  const EdgeScale& scale;
  bool off_scale;  // a sharp edge in a picture of curvature

  void operator()(double value, Stroke& stroke) const {
    constexpr EdgePaint kPaint;
    stroke.rank = -1;
    if (edge.kind == EdgeKind::free)
      stroke.colour = kPaint.free;
    else if (edge.kind == EdgeKind::non_manifold)
      stroke.colour = kPaint.non_manifold;
    else if (off_scale || !finite(value))
      stroke.colour = kPaint.unknown;
    else
      stroke.colour = scale.at(value), stroke.rank = value;
  }
};

}  // namespace

Colour EdgeScale::at(double value) const {
  const double share = std::log(std::max(value * factor, 1e-300) / lo) / std::log(hi / lo);
  const double place = std::clamp(share, 0.0, 1.0) * static_cast<double>(colours.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(place), colours.size() - 2);
  return glm::mix(colours[i], colours[i + 1], static_cast<float>(place - static_cast<double>(i)));
}

EdgeScale edge_scale(const ContinuityReport& report) {
  constexpr double kDecade = 10;
  const ContinuitySettings& settings = report.settings;
  const double tolerance = settings.tolerance[static_cast<std::size_t>(settings.by)];
  EdgeScale scale;
  scale.factor = settings.by == Measure::normal ? kDegrees : 1;
  const std::string unit = report.unit.empty() ? "units" : report.unit;
  scale.label = settings.by == Measure::normal ? "normal jump, deg"
                : settings.by == Measure::gap  ? "gap, " + unit
                                               : "curvature jump, 1 / " + unit;
  scale.lo = scale.factor * tolerance / kDecade;
  scale.hi = scale.factor * std::max(settings.scale.value_or(largest(report, settings.by)), kDecade * tolerance);
  for (const Colour& c : even_scale()) scale.colours.push_back({linear_from_srgb(c.r), linear_from_srgb(c.g), linear_from_srgb(c.b)});
  return scale;
}

std::string legend_text(const ContinuityReport& report, const EdgeScale& scale) {
  return fmt::format("colours: {} from {:.3g} (dark violet) to {:.3g} (yellow), logarithmic; free edges red, non-manifold ones black{}\n",
                     scale.label, scale.lo, scale.hi, report.settings.by == Measure::curvature ? ", sharp ones dark grey" : "");
}

void draw_edges(std::vector<glm::vec4>& rgba, const ContinuityReport& report, const Model& model, const EdgeScale& scale,
                const Tracer& tracer, const Camera& camera, const ImageSize& size) {
  const Measure by = report.settings.by;
  std::vector<Stroke> strokes;
  EdgeStrokes lines(camera, size, strokes);
  for (const Instance& instance : model.instances)
    for (const EdgeContinuity& edge : report.parts[static_cast<std::size_t>(instance.part)].continuity.edges) {
      const ContinuityClass known = class_of(edge, report.settings);
      const bool is_tangent = known == ContinuityClass::G1 || known == ContinuityClass::G2;
      const EdgePainter painter{edge, scale, by == Measure::curvature && !is_tangent};
      for (std::size_t i = 0; i + 1 < edge.samples.size(); ++i) {
        const ContinuitySample &a = edge.samples[i], &b = edge.samples[i + 1];
        const double va = a.value[static_cast<std::size_t>(by)], vb = b.value[static_cast<std::size_t>(by)];
        lines.add(instance.to_model.point(a.place), finite(va) ? va : vb, instance.to_model.point(b.place), finite(vb) ? vb : va, painter);
      }
    }
  drop_hidden(strokes, tracer, camera, size);
  paint_strokes(rgba, strokes, size);
}

}  // namespace iso
