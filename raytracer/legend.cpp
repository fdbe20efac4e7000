#include "raytracer/legend.h"

#include <fmt/format.h>

#include "raytracer/bitmap_font.h"

namespace iso {
namespace {

// Lengths in dots.
constexpr int kPadding = 4, kGap = 3, kBarHeight = 7, kTick = 2, kBetweenNumbers = 2 * kGlyphAdvance;
constexpr double kWidth = 0.6;         // of the picture: the bar
constexpr double kPixelsPerDot = 300;  // of the picture's height: texts are about a fortieth of it high
constexpr double kHighest = 0.5;       // of the picture: a higher panel is left out
constexpr float kPanelLight = 0.010f, kPanelCover = 0.80f, kTextLight = 0.92f;

std::string number_text(double value) {
  const std::string text = fmt::format("{:.4g}", value);
  return text == "-0" ? "0" : text;
}

// The widest even division of the range whose numbers stand apart: in four, two or one.
std::vector<double> numbered_values(const Range& range, int bar_dots) {
  for (const int parts : {4, 2, 1}) {
    std::vector<double> values;
    int widest = 0;
    for (int i = 0; i <= parts; ++i) {
      values.push_back(i == parts ? range.hi : range.lo + range.width() * i / parts);
      widest = std::max(widest, text_width(number_text(values.back())));
    }
    if (widest + kBetweenNumbers <= bar_dots / parts) return values;
  }
  return {};
}

void cover(Film& film, const PixelBox& box, const Colour& colour, float share) {
  for (int y = box.y0; y < box.y1; ++y)
    for (int x = box.x0; x < box.x1; ++x) {
      const glm::vec4 under =
          film.rgba[static_cast<std::size_t>(y) * static_cast<std::size_t>(film.size().width) + static_cast<std::size_t>(x)];
      film.set_colour(x, y, glm::vec4(colour, 1.0f) * share + under * (1 - share));
    }
}

void draw_text(Film& film, const LegendText& text, int dot) {
  for (std::size_t i = 0; i < text.text.size(); ++i)
    for (int row = 0; row < kGlyphHeight; ++row)
      for (int column = 0; column < kGlyphWidth; ++column) {
        if (!glyph_dot(text.text[i], column, row)) continue;
        const int x = text.x + (static_cast<int>(i) * kGlyphAdvance + column) * dot, y = text.y + row * dot;
        cover(film, {x, y, x + dot, y + dot}, Colour(kTextLight), 1);
      }
}

}  // namespace

std::optional<LegendLayout> layout_of(const Legend& legend, const ImageSize& size) {
  LegendLayout layout;
  const int dot = layout.dot = std::max(1, static_cast<int>(std::lround(size.height / kPixelsPerDot)));
  const Range& range = legend.scale.range;
  const int bar_dots = static_cast<int>(kWidth * size.width) / dot;
  const std::vector<double> values = numbered_values(range, bar_dots);
  if (values.empty()) return {};

  // Numbers stand under their ticks; the outer ones reach beyond the bar.
  const int overhang = std::max(text_width(number_text(values.front())), text_width(number_text(values.back()))) / 2 + 1;
  const int wide = std::max(bar_dots + 2 * overhang, text_width(legend.title)) + 2 * kPadding;
  const int high = 2 * kGlyphHeight + 2 * kGap + kBarHeight + kTick + 2 * kPadding;
  const int margin = kPadding * dot;
  const int x0 = (size.width - wide * dot) / 2, y0 = size.height - margin - high * dot;
  if (x0 < 0 || high * dot > kHighest * size.height) return {};
  layout.panel = {x0, y0, x0 + wide * dot, y0 + high * dot};

  const int title_y = y0 + kPadding * dot, bar_y = title_y + (kGlyphHeight + kGap) * dot, bar_x = (size.width - bar_dots * dot) / 2;
  layout.title = {(size.width - text_width(legend.title) * dot) / 2, title_y, legend.title};
  layout.bar = {bar_x, bar_y, bar_x + bar_dots * dot, bar_y + kBarHeight * dot};
  const int number_y = layout.bar.y1 + (kTick + kGap) * dot;
  for (const double value : values) {
    const std::string text = number_text(value);
    const int tick = bar_x + static_cast<int>(std::lround((value - range.lo) / range.width() * (bar_dots - 1))) * dot;
    layout.ticks.push_back(tick);
    layout.numbers.push_back({tick + dot / 2 - text_width(text) * dot / 2, number_y, text});
  }
  return layout;
}

double value_in_bar(const Legend& legend, const LegendLayout& layout, int column) {
  const double share = (column + 0.5 - layout.bar.x0) / (layout.bar.x1 - layout.bar.x0);
  return legend.scale.range.lo + legend.scale.range.width() * share;
}

bool draw_legend(const Legend& legend, Film& film) {
  const auto layout = layout_of(legend, film.size());
  if (!layout) return false;
  cover(film, layout->panel, Colour(kPanelLight), kPanelCover);
  for (int x = layout->bar.x0; x < layout->bar.x1; ++x)
    cover(film, {x, layout->bar.y0, x + 1, layout->bar.y1}, legend.scale.colour(value_in_bar(legend, *layout, x)), 1);
  for (const int tick : layout->ticks)
    cover(film, {tick, layout->bar.y1, tick + layout->dot, layout->bar.y1 + kTick * layout->dot}, Colour(kTextLight), 1);
  draw_text(film, layout->title, layout->dot);
  for (const LegendText& number : layout->numbers) draw_text(film, number, layout->dot);
  return true;
}

}  // namespace iso
