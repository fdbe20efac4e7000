#include "raytracer/cmd/compare_charts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "patches/base/vec.h"
#include "raytracer/cmd/page_text.h"

namespace iso {
namespace {

// The drawing, in units of the view box; the plot of the decades ends where the band of the exact line begins.
constexpr double kWidth = 460, kHeight = 350, kLeft = 62, kRight = 428, kTop = 16, kBottom = 246, kExact = 272;
constexpr double kCharacter = 7.2, kLine = 15;  // size of small text, about

// The decades an axis shows, as powers of ten.
struct Decades {
  int lo = 0, hi = 1;
  double at(double x, double from, double to) const { return from + (std::log10(x) - lo) / (hi - lo) * (to - from); }
  int step() const { return (hi - lo + 5) / 6; }  // at most six labels
  int grid_step() const { return hi - lo > 12 ? step() : 1; }
};

// The smallest run of decades that holds all of them with a little air; values are positive.
Decades decades_of(const std::vector<double>& values) {
  constexpr double kAir = 0.08;  // decades
  if (values.empty()) return {};
  const auto [lo, hi] = std::minmax_element(values.begin(), values.end());
  const int below = static_cast<int>(std::floor(std::log10(*lo) - kAir)), above = static_cast<int>(std::ceil(std::log10(*hi) + kAir));
  return {below, std::max(above, below + 1)};
}

std::string tick_text(int power, ChartUnit unit) {
  const double value = std::pow(10.0, power);
  switch (unit) {
    case ChartUnit::count:
      return power <= 6 ? figure_text(value) : fmt::format("1e{}", power);
    case ChartUnit::seconds:
      return power < -3 ? figure_text(1e6 * value) + " µs" : power < 0 ? figure_text(1e3 * value) + " ms" : figure_text(value) + " s";
    case ChartUnit::bytes:
      return power < 3   ? figure_text(value) + " B"
             : power < 6 ? figure_text(1e-3 * value) + " kB"
             : power < 9 ? figure_text(1e-6 * value) + " MB"
                         : figure_text(1e-9 * value) + " GB";
    case ChartUnit::plain:
      return power < -2 || power > 4 ? fmt::format("1e{}", power) : figure_text(value);
  }
  return {};
}

struct Rectangle {
  double x0, y0, x1, y1;
  bool meets(const Rectangle& o) const { return x0 < o.x1 && o.x0 < x1 && y0 < o.y1 && o.y0 < y1; }
};

class Drawing {
 public:
  explicit Drawing(const Chart& chart) : chart_(chart) {
    std::vector<double> xs, ys;
    for (const ChartPoint& p : chart.points) {
      if (!std::isfinite(p.x) || !(p.x > 0) || !std::isfinite(p.y)) continue;
      points_.push_back(&p);
      xs.push_back(p.x);
      if (p.y > 0) ys.push_back(p.y);
    }
    if (chart.exact_x && std::isfinite(*chart.exact_x) && *chart.exact_x > 0) exact_x_ = chart.exact_x, xs.push_back(*exact_x_);
    x_ = decades_of(xs);
    y_ = decades_of(ys);
  }

  std::string svg() {
    if (points_.empty()) return {};
    const std::string title = escaped(chart_.title);
    out_ = fmt::format("<svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">\n<title>{}</title>\n", kWidth, kHeight, title, title);
    axes();
    exact_line();
    guide();
    marks();
    return out_ + "</svg>\n";
  }

 private:
  double px(double x) const { return x_.at(x, kLeft, kRight); }
  double py(double y) const { return y > 0 ? y_.at(y, kBottom, kTop) : kExact; }

  void line(const char* kind, double x0, double y0, double x1, double y1) {
    out_ += fmt::format("<line class=\"{}\" x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\"/>\n", kind, x0, y0, x1, y1);
  }
  void text(const char* kind, double x, double y, const char* anchor, const std::string& words) {
    out_ += fmt::format("<text class=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", kind, x, y, anchor, escaped(words));
  }

  void axes() {
    for (int d = x_.lo; d <= x_.hi; d += x_.grid_step()) {
      const double x = px(std::pow(10.0, d));
      line("grid", x, kTop, x, kExact + 8);
      if ((d - x_.lo) % x_.step() == 0) text("tick", x, kExact + 24, "middle", tick_text(d, chart_.x_unit));
    }
    for (int d = y_.lo; d <= y_.hi; d += y_.grid_step()) {
      const double y = py(std::pow(10.0, d));
      line("grid", kLeft, y, kRight, y);
      if ((d - y_.lo) % y_.step() == 0) text("tick", kLeft - 6, y + 4, "end", tick_text(d, ChartUnit::plain));
    }
    text("axis", 0.5 * (kLeft + kRight), kHeight - 30, "middle", chart_.x_title);
    out_ += fmt::format("<text class=\"axis\" transform=\"translate(13 {:.1f}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
                        0.5 * (kTop + kBottom), escaped(chart_.y_title));
  }

  // The line at zero, with the direct renderer's place on it where it has one.
  void exact_line() {
    text("tick exact-text", kLeft - 6, kExact + 4, "end", "exact: 0");
    line("exact", kLeft, kExact, kRight, kExact);
    if (exact_x_)
      out_ += fmt::format("<rect class=\"exact-mark\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"11\" height=\"11\"><title>{}</title></rect>\n",
                          px(*exact_x_) - 5.5, kExact - 5.5, escaped(chart_.exact_text));
    text("tick exact-text", 0.5 * (kLeft + kRight), kHeight - 8, "middle", chart_.exact_text);
    taken_.push_back({kLeft, kExact - 7, kRight, kExact + 7});
  }

  // y ~ 1/x through the last point of ours, over the x of ours, cut off at the plot's border.
  void guide() {
    double lo = kInf, hi = 0;
    const ChartPoint* last = nullptr;
    for (const ChartPoint* p : points_) {
      if (!p->ours || !(p->y > 0)) continue;
      lo = std::min(lo, p->x), hi = std::max(hi, p->x), last = p;
    }
    if (chart_.guide_text.empty() || !last || !(lo < hi)) return;
    const double product = last->x * last->y;
    lo = std::max(lo, product / std::pow(10.0, y_.hi)), hi = std::min(hi, product / std::pow(10.0, y_.lo));
    if (!(lo < hi)) return;
    line("guide", px(lo), py(product / lo), px(hi), py(product / hi));
    text("tick guide-text", kRight, kTop + 12, "end", chart_.guide_text);
    const double width = kCharacter * static_cast<double>(chart_.guide_text.size());
    taken_.push_back({kRight - width, kTop, kRight, kTop + kLine});
  }

  void marks() {
    std::string path;
    for (const ChartPoint* p : points_)
      if (p->ours) path += fmt::format("{}{:.1f},{:.1f}", path.empty() ? "" : " ", px(p->x), py(p->y));
    out_ += fmt::format("<polyline class=\"ours-line\" points=\"{}\"/>\n", path);
    for (const ChartPoint* p : points_) taken_.push_back({px(p->x) - 5, py(p->y) - 5, px(p->x) + 5, py(p->y) + 5});
    for (const ChartPoint* p : points_) {
      const double x = px(p->x), y = py(p->y);
      const std::string told = escaped(p->label + ": " + figure_text(p->y));
      out_ += p->ours
                  ? fmt::format("<circle class=\"ours\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4.5\"><title>{}</title></circle>\n", x, y, told)
                  : fmt::format("<path class=\"theirs\" d=\"M{:.1f} {:.1f}l6 6l-6 6l-6-6z\"><title>{}</title></path>\n", x, y - 6, told);
      label(*p, x, y);
    }
  }

  // Beside its mark where there is room: a falling line leaves free what is above to the right and below to the left.
  void label(const ChartPoint& p, double x, double y) {
    constexpr std::size_t kLongest = 20;
    const std::string words = shortened(p.label, kLongest);
    const double width = kCharacter * static_cast<double>(std::min(words.size(), kLongest));
    const struct {
      double x, y;
      const char* anchor;
    } places[] = {
        {x + 8, y - 7, "start"}, {x - 8, y + 17, "end"}, {x + 9, y + 5, "start"}, {x - 9, y - 8, "end"}, {x + 8, y + 18, "start"}};
    for (const auto& at : places) {
      const double left = *at.anchor == 's' ? at.x : at.x - width;
      const Rectangle box{left, at.y - 11, left + width, at.y + 3};
      if (box.x0 < kLeft || box.x1 > kRight + 4 || box.y0 < 0) continue;
      if (std::any_of(taken_.begin(), taken_.end(), [&](const Rectangle& other) { return box.meets(other); })) continue;
      taken_.push_back(box);
      text(p.ours ? "tick ours-text" : "tick theirs-text", at.x, at.y, at.anchor, words);
      return;
    }
  }

  const Chart& chart_;
  std::vector<const ChartPoint*> points_;
  std::optional<double> exact_x_;
  Decades x_, y_;
  std::string out_;
  std::vector<Rectangle> taken_;
};

}  // namespace

std::string chart_svg(const Chart& chart) { return Drawing(chart).svg(); }

}  // namespace iso
