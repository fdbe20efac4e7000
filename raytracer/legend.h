// A legend in the picture: a bar with the colours of a scale, numbers under it, and a line that says what they are.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "raytracer/colour_scale.h"
#include "raytracer/film.h"

namespace iso {

struct Legend {
  std::string title;  // in the characters of bitmap_font.h
  ColourScale scale;
};

struct LegendText {
  int x, y;  // pixels of its upper left corner
  std::string text;
};

// A rectangle of pixels; x1 and y1 lie outside.
struct PixelBox {
  int x0, y0, x1, y1;
};

// Where it goes: at the bottom, in the middle. Texts stand in dots of `dot` x `dot` pixels, larger in larger pictures.
struct LegendLayout {
  int dot = 1;
  PixelBox panel{}, bar{};
  LegendText title;
  std::vector<LegendText> numbers;
  std::vector<int> ticks;  // columns of pixels, one per number
};

// Nothing if the picture is too small for it.
std::optional<LegendLayout> layout_of(const Legend& legend, const ImageSize& size);

// The value that the middle of a column of the bar stands for.
double value_in_bar(const Legend& legend, const LegendLayout& layout, int column);

// Draws over the colours, on a dark, slightly clear panel; data layers stay. False if there is no room.
bool draw_legend(const Legend& legend, Film& film);

}  // namespace iso
