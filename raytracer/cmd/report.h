// What `render` and `hit` say about their work when they are done.
#pragma once

#include <string>

#include "raytracer/tracer.h"

namespace iso {

// Largest memory the process has used so far, bytes.
std::uint64_t peak_memory();

// "0 fallbacks, 3 tangent, 12 by tolerance, 0 out of budget": the solver's rare branches.
std::string rare_branches(const SolverStats& stats);

// Every counter, one a line.
std::string full_statistics(const BuildStats& build, const SolverStats& stats);

// The same as a JSON object.
std::string statistics_json(const BuildStats& build, const SolverStats& stats);

}  // namespace iso
