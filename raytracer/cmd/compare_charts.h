// Log-log charts as inline SVG for the page of a comparison. Colours come from the page's style, so that they follow its light or dark.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace iso {

struct ChartPoint {
  std::string label;
  double x = 0, y = 0;  // x positive and y finite, else the point is left out; y <= 0 lies on the line of what is exact
  bool ours = false;    // joined by a line, in the order given
};

// How the numbers along an axis are written.
enum class ChartUnit { count, seconds, bytes, plain };

struct Chart {
  std::string title, x_title, y_title;
  ChartUnit x_unit = ChartUnit::plain;
  std::vector<ChartPoint> points;
  // Below the decades runs the line of error zero, which no logarithm has. `exact_x`: where on it the direct renderer is; nothing:
  // everywhere.
  std::optional<double> exact_x;
  std::string exact_text;
  std::string guide_text;  // of a line y ~ 1/x through the last point of ours; empty: none
};

// An <svg> element; empty if there is nothing to draw. Texts may hold anything.
std::string chart_svg(const Chart& chart);

}  // namespace iso
