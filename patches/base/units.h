// Units of length by their names in models, meshes and on the command line.
#pragma once

#include <array>
#include <optional>
#include <string_view>

namespace iso {

struct LengthUnit {
  std::string_view name;
  double metres;
};
inline constexpr std::array kLengthUnits{LengthUnit{"um", 1e-6}, LengthUnit{"mm", 1e-3},   LengthUnit{"cm", 0.01},
                                         LengthUnit{"m", 1},     LengthUnit{"in", 0.0254}, LengthUnit{"ft", 0.3048}};

// Nothing for other names.
constexpr std::optional<double> metres_of(std::string_view unit) {
  for (const LengthUnit& u : kLengthUnits)
    if (u.name == unit) return u.metres;
  return {};
}

}  // namespace iso
