// The seven models that BRL-CAD was measured on, with what they hold.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>

#include "tests/support/paths.h"

namespace iso::test {

struct BrlCadModel {
  const char* name;
  const char* file;     // in the folder cad of the collections
  const char* in_occt;  // in the package occt-misc, or null
  int faces;            // placed
  bool solid;           // closed; else open shells
};

inline constexpr std::array<BrlCadModel, 7> kBrlCadModels{{
    {"nist-mbe-pmi-03", "nist-mbe-pmi-03.stp", nullptr, 120, true},
    {"netgen-frame", "netgen-frame.step", nullptr, 375, true},
    {"linkrods", "occt-linkrods.step", "step/linkrods.step", 37, true},
    {"as1-oc-214", "stepcode-as1-oc-214.stp", nullptr, 160, true},
    {"tigl-nacelle", "tigl-nacelle.stp", nullptr, 6, false},
    {"goteborg-hull", "dealii-goteborg-hull.step", nullptr, 3, false},
    {"screw", "occt-screw.step", "step/screw.step", 10, true},
}};

// Where the file is: in the source tree, the package occt-misc or the larger collection; none if it is nowhere.
inline std::optional<std::string> path_of(const BrlCadModel& model) {
  const auto file = std::filesystem::path("cad") / model.file;
  if (std::filesystem::exists(data_dir() / file)) return (data_dir() / file).string();
  if (const auto occt = occt_data_dir(); occt && model.in_occt && std::filesystem::exists(*occt / model.in_occt))
    return (*occt / model.in_occt).string();
  if (const auto shared = shared_data_dir(); shared && std::filesystem::exists(*shared / file)) return (*shared / file).string();
  return std::nullopt;
}

}  // namespace iso::test
