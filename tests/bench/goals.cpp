#include "tests/bench/goals.h"

#include <algorithm>
#include <vector>

namespace iso::bench {
namespace {

struct GoalOfKind {
  const char* about;
  std::vector<std::string> scenes;
  const char* rays;
  std::optional<double> coarse, fine;  // at a tolerance of 1e-4; at 1e-6, of CAD models at 1e-5
};

constexpr double kCoarse = 1e-4;

const std::vector<GoalOfKind>& goals() {
  const std::vector<std::string> large{"wavy-torus"}, small{"small-torus"}, rational{"rational-torus"}, analytic{"plate"};
  const std::vector<std::string> trimmed{"linkrods", "motor-c", "hammer", "propeller"}, to_image{"linkrods", "motor-c"};
  static const std::vector<GoalOfKind> all{
      {"primary, 2048 bicubics", large, "primary", 1.0, 3.7},
      {"bounce, 2048 bicubics", large, "bounce", 1.2, 2.1},
      {"bounce, 32 bicubics", small, "bounce", 1.5, 2.9},
      {"room, 2048 bicubics", large, "room", 0.95, 2.5},
      {"room, 32 bicubics", small, "room", 1.1, 3.9},
      {"scattered single rays", large, "scattered", 0.8, 2.3},
      {"primary, rational biquadratics", rational, "primary", 0.9, 2.7},
      {"bounce, rational biquadratics", rational, "bounce", 1.3, 2.7},
      {"primary, analytic faces", analytic, "primary", 1.1, {}},
      {"bounce, analytic faces", analytic, "bounce", 2.0, {}},
      {"room, analytic faces", analytic, "room", 2.4, {}},
      {"primary, trimmed CAD", trimmed, "primary", 0.9, 1.2},
      {"bounce, trimmed CAD", trimmed, "bounce", 1.5, 1.8},
      {"room, trimmed CAD", trimmed, "room", 1.2, 1.5},
      {"build and 1 Mpixel, against GRID", large, "build-grid", 1.5, 10},
      {"build and 1 Mpixel, against HIGH", large, "build-high", 4, 120},
      {"parsed model to first image", to_image, "first-image", 15, 200},
      {"memory, against GRID", large, "memory", 1.3, 100},
      {"AVX2, primary", large, "primary-avx2", 0.9, 2.5},
      {"AVX2, bounce", large, "bounce-avx2", 0.9, 2.5},
      {"two threads against one", large, "two-threads", 1.8, {}},
  };
  return all;
}

}  // namespace

std::optional<Goal> goal_of(const std::string& scene, const std::string& rays, double tolerance) {
  for (const GoalOfKind& goal : goals()) {
    if (rays != goal.rays || std::find(goal.scenes.begin(), goal.scenes.end(), scene) == goal.scenes.end()) continue;
    const std::optional<double> must = tolerance > 0 && tolerance < kCoarse ? goal.fine : goal.coarse;
    return must ? std::optional(Goal{goal.about, *must}) : std::nullopt;
  }
  return std::nullopt;
}

}  // namespace iso::bench
