// The seven models that BRL-CAD was measured on: how fast their rays are traced, and how many of them answer wrongly.
//
// BRL-CAD does not run here. Its figures are constants, of version 7.32.6 (2022-05), measured apart: built from source with -O3 without
// -flto and run headless on one thread of a machine of the same kind (AMD EPYC), rt_shootray with a_onehit = 1 on 100,000 random rays
// through each model's box, in CPU seconds, read as +-20 %. Where two figures were taken the faster one stands.
#pragma once

#include <nlohmann/json.hpp>

#include "patches/base/result.h"
#include "tests/bench/report.h"
#include "tests/bench/timing.h"
#include "tests/support/brl_cad_models.h"
#include "tests/support/wrong_rays.h"

namespace iso::bench {

struct BrlCadOptions {
  int rounds = 5;
  std::size_t rays = 1000000;
};

struct BrlCadRecord {
  const char* model;
  double rays_per_second;  // one thread
  double wrong;            // share of the rays
  const char* import;      // how the file got in
};

struct BrlCadRow {
  test::BrlCadModel model{};
  BrlCadRecord theirs{};
  int faces = 0, mesh_faces = 0;  // of ours, and as Open CASCADE counts them
  std::size_t problems = 0, dropped = 0;
  bool closed = false, valid = false;  // every edge of a solid joins two faces; Open CASCADE's check finds nothing wrong
  Timing ns_per_ray;
  test::RayCounts counts;
  double mesh_deflection = 0;  // asked for, share of the diagonal
  std::size_t triangles = 0;
  std::size_t unmeshed = 0;

  double rays_per_second() const { return 1e9 / ns_per_ray.median; }
  double ratio() const { return rays_per_second() / theirs.rays_per_second; }
  double wrong() const { return static_cast<double>(counts.wrong()) / static_cast<double>(counts.rays); }
};

inline constexpr double kBrlCadRatio = 100, kMostWrong = 1e-5;  // the goals

// Errors: the model cannot be read.
Result<BrlCadRow> measure_against_brl_cad(const test::BrlCadModel& model, const std::string& path, const BrlCadOptions& options);

std::string brl_cad_table(const std::vector<BrlCadRow>& rows, const BrlCadOptions& options, const Origin& origin);
nlohmann::ordered_json brl_cad_json(const std::vector<BrlCadRow>& rows, const BrlCadOptions& options, const Origin& origin);

}  // namespace iso::bench
