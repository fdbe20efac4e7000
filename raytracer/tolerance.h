// How near a mesh must come to the surface, as the command line says it: "0.05mm", "1e-4d", "0.01".
#pragma once

#include <string>
#include <string_view>

#include "patches/base/result.h"

namespace iso {

// What a tolerance counts in: the model's own unit (a bare number), a unit of length, or the diagonal of the model's box.
enum class ToleranceUnit { model, metre, centimetre, millimetre, micrometre, inch, foot, diagonal };

struct Tolerance {
  double value = 0;  // positive and finite
  ToleranceUnit unit = ToleranceUnit::model;
};

// `option` is what errors name. A number and, next to it or after blanks, one of m cm mm um in ft d, or nothing.
Result<Tolerance> tolerance_named(std::string_view text, std::string_view option = "--tolerance");

// "0.001 d", "0.05 mm", "3" if it counts in the model's unit and that is unknown.
std::string text_of(const Tolerance& tolerance, std::string_view unit_of_model);

// In units of the model. `diagonal`: of its box, in these units. `unit_of_model`: one of m cm mm um in ft, or empty if unknown; then a
// tolerance with a unit of length is an error, and so is one that is not a positive finite number of units, or
// finer than 1e-12 diagonals.
Result<double> in_units(const Tolerance& tolerance, double diagonal, std::string_view unit_of_model,
                        std::string_view option = "--tolerance");

}  // namespace iso
