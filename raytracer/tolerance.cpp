#include "raytracer/tolerance.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <optional>

#include "patches/base/units.h"

namespace iso {
namespace {

// In the order of ToleranceUnit, from metre on.
constexpr std::array<std::string_view, 6> kNames{"m", "cm", "mm", "um", "in", "ft"};
static_assert(static_cast<int>(ToleranceUnit::metre) == 1 && static_cast<int>(ToleranceUnit::diagonal) == 1 + int(kNames.size()));

// Of a unit of length.
std::string_view name_of(ToleranceUnit unit) { return kNames[static_cast<std::size_t>(unit) - 1]; }

std::optional<ToleranceUnit> unit_named(std::string_view name) {
  if (name.empty()) return ToleranceUnit::model;
  if (name == "d") return ToleranceUnit::diagonal;
  for (std::size_t i = 0; i < kNames.size(); ++i)
    if (name == kNames[i]) return static_cast<ToleranceUnit>(i + 1);
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

std::string text_of(const Tolerance& tolerance, std::string_view unit_of_model) {
  const std::string_view unit = tolerance.unit == ToleranceUnit::model      ? unit_of_model
                                : tolerance.unit == ToleranceUnit::diagonal ? "d"
                                                                            : name_of(tolerance.unit);
  return unit.empty() ? fmt::format("{:g}", tolerance.value) : fmt::format("{:g} {}", tolerance.value, unit);
}

Result<double> in_units(const Tolerance& tolerance, double diagonal, std::string_view unit_of_model, std::string_view option) {
  double units = tolerance.value;
  if (tolerance.unit == ToleranceUnit::diagonal) {
    units *= diagonal;
  } else if (tolerance.unit != ToleranceUnit::model) {
    const std::string_view asked = name_of(tolerance.unit);
    const auto own = unit_named(unit_of_model);
    if (!own || *own == ToleranceUnit::model || *own == ToleranceUnit::diagonal)
      return Error{Exit::bad_command_line,
                   {},
                   {},
                   fmt::format("{}: found a length in {}, but the unit of the model is {}; expected a bare number in its units, or "
                               "diagonals such as 1e-4d",
                               option, asked, unit_of_model.empty() ? "unknown" : fmt::format("'{}'", unit_of_model))};
    units *= *metres_of(asked) / *metres_of(unit_of_model);
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
