#include "raytracer/tolerance.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <optional>

namespace iso {
namespace {

struct Length {
  std::string_view name;
  ToleranceUnit unit;
  double metres;
};
constexpr std::array kLengths{Length{"m", ToleranceUnit::metre, 1},          Length{"cm", ToleranceUnit::centimetre, 0.01},
                              Length{"mm", ToleranceUnit::millimetre, 1e-3}, Length{"um", ToleranceUnit::micrometre, 1e-6},
                              Length{"in", ToleranceUnit::inch, 0.0254},     Length{"ft", ToleranceUnit::foot, 0.3048}};

const Length& length_of(ToleranceUnit unit) {
  for (const Length& l : kLengths)
    if (l.unit == unit) return l;
  ISO_CHECK(!"a unit of length");
}

std::optional<ToleranceUnit> unit_named(std::string_view name) {
  if (name.empty()) return ToleranceUnit::model;
  if (name == "d") return ToleranceUnit::diagonal;
  for (const Length& l : kLengths)
    if (name == l.name) return l.unit;
  return {};
}

// Of the diagonal; some thousand times the rounding of coordinates.
constexpr double kFinest = 1e-12;

constexpr const char* kExpected = "expected a positive number with one of m cm mm um in ft, d (diagonals of the model's box) or nothing";

Error bad_tolerance(std::string_view option, const std::string& found) {
  return {Exit::bad_command_line, {}, {}, fmt::format("{}: found {}, {}", option, found, kExpected)};
}

}  // namespace

Result<Tolerance> tolerance_named(std::string_view text, std::string_view option) {
  Tolerance tolerance;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), tolerance.value);
  if (code == std::errc::result_out_of_range) return bad_tolerance(option, fmt::format("'{}', beyond the range of numbers", text));
  if (code != std::errc{}) return bad_tolerance(option, fmt::format("'{}'", text));
  if (!(tolerance.value > 0) || !std::isfinite(tolerance.value)) return bad_tolerance(option, fmt::format("'{}'", text));
  std::string_view rest = text.substr(static_cast<std::size_t>(end - text.data()));
  while (!rest.empty() && rest.front() == ' ') rest.remove_prefix(1);
  const auto unit = unit_named(rest);
  if (!unit) return bad_tolerance(option, fmt::format("unit '{}' in '{}'", rest, text));
  tolerance.unit = *unit;
  return tolerance;
}

Result<double> in_units(const Tolerance& tolerance, double diagonal, std::string_view unit_of_model, std::string_view option) {
  double units = tolerance.value;
  if (tolerance.unit == ToleranceUnit::diagonal) {
    units *= diagonal;
  } else if (tolerance.unit != ToleranceUnit::model) {
    const Length& asked = length_of(tolerance.unit);
    const auto own = unit_named(unit_of_model);
    if (!own || *own == ToleranceUnit::model || *own == ToleranceUnit::diagonal)
      return Error{Exit::bad_command_line,
                   {},
                   {},
                   fmt::format("{}: found a length in {}, but the unit of the model is {}; expected a bare number in its units, or "
                               "diagonals such as 1e-4d",
                               option, asked.name, unit_of_model.empty() ? "unknown" : fmt::format("'{}'", unit_of_model))};
    units *= asked.metres / length_of(*own).metres;
  }
  if (units > 0 && units < kFinest * diagonal)
    return Error{Exit::bad_command_line,
                 {},
                 {},
                 fmt::format("{}: found {:.3g} units of a model with a diagonal of {:.3g}, finer than its coordinates can be told apart; "
                             "expected at least {:g} diagonals",
                             option, units, diagonal, kFinest)};
  if (units > 0 && std::isfinite(units)) return units;
  return bad_tolerance(option, fmt::format("{:g} units of a model with a diagonal of {:g}", units, diagonal));
}

}  // namespace iso
