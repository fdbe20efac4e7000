// `isophote hit MODEL`: rays on standard input, hits on standard output.
#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

#include <memory>
#include <optional>

#include "raytracer/cmd/command.h"
#include "raytracer/cmd/line_source.h"
#include "raytracer/cmd/load_models.h"
#include "raytracer/cmd/patches_option.h"
#include "raytracer/cmd/report.h"
#include "raytracer/ray_text.h"

namespace iso {
namespace {

struct Options {
  std::string model;
  PatchesOption patches;
  bool nearest = false, json = false, stats = false;
  int threads = 0;
};

constexpr std::size_t kBatch = 1 << 16;  // lines read at a time
constexpr std::size_t kChunk = 1 << 11;  // lines one task parses, traces and formats

// The work of one task, and what came of it.
struct Chunk {
  std::string out;
  SolverStats stats{};
  std::optional<Error> error;
};

// Rays of some lines with the numbers of these lines; stops at the first line that is not one.
void parse_lines(std::span<const InputLine> lines, std::vector<Ray>& rays, std::vector<std::uint64_t>& numbers, Chunk& chunk) {
  for (const InputLine& line : lines) {
    if (is_skipped(line.text)) continue;
    auto ray = parse_ray(line.text);
    if (!ray) {
      chunk.error = bad_input("standard input", fmt::format("line {}", line.number + 1), ray.error().message);
      return;
    }
    rays.push_back(*ray);
    numbers.push_back(line.number);
  }
}

void trace_lines(const Tracer& tracer, const Options& options, std::span<const InputLine> lines, Chunk& chunk) {
  std::vector<Ray> rays;
  std::vector<std::uint64_t> numbers;
  parse_lines(lines, rays, numbers, chunk);

  // Hits of ray i are [offsets[i], offsets[i + 1]); with --nearest at most one.
  std::vector<Hit> hits;
  std::vector<std::size_t> offsets;
  const HitFormat format = options.json ? HitFormat::json : HitFormat::text;
  if (options.nearest) {
    hits.resize(rays.size());
    tracer.nearest(rays, hits, Tracer::Order::scattered, chunk.stats);
  } else {
    tracer.all(rays, hits, offsets, chunk.stats);
  }
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const std::size_t first = options.nearest ? i : offsets[i];
    const std::size_t last = options.nearest ? i + (hits[i] ? 1 : 0) : offsets[i + 1];
    if (first == last) append_miss(chunk.out, format, numbers[i]);
    for (std::size_t h = first; h < last; ++h) append_hit(chunk.out, format, numbers[i], tracer, hits[h]);
  }
}

// All lines of standard input; output in their order.
Status trace_input(const Tracer& tracer, const Options& options, SolverStats& stats) {
  LineSource source;
  std::vector<InputLine> lines;
  while (true) {
    if (const auto status = source.next(kBatch, lines); !status) return status.error();
    if (lines.empty()) return Done{};
    std::vector<Chunk> chunks((lines.size() + kChunk - 1) / kChunk);
    tbb::parallel_for(std::size_t{0}, chunks.size(), [&](std::size_t c) {
      const std::size_t first = c * kChunk, count = std::min(kChunk, lines.size() - first);
      trace_lines(tracer, options, std::span(lines).subspan(first, count), chunks[c]);
    });
    for (const Chunk& chunk : chunks) {
      if (const auto written = write_stdout(chunk.out); !written) return written.error();
      stats += chunk.stats;
      if (chunk.error) return *chunk.error;
    }
  }
}

Exit hit(const Options& options) {
  const auto threads = static_cast<std::size_t>(options.threads > 0 ? options.threads : tbb::info::default_concurrency());
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  auto loaded = load_models({{options.model, {}, {}, options.patches.kind()}}, {});
  if (!loaded) return fail(loaded.error());
  const Tracer tracer(std::move(loaded->scene));
  SolverStats stats;
  const auto done = trace_input(tracer, options, stats);
  if (options.stats) fmt::print(stderr, "{}", full_statistics(tracer.build_stats(), stats));
  return done ? Exit::done : fail(done.error());
}

constexpr const char* kHitHelp =
    "Input: one ray a line, 'ox oy oz dx dy dz', in the model's coordinates (millimetres for STEP and IGES). Blank lines and lines that "
    "begin\n"
    "with # are skipped, but counted. Output: one line per hit, in order along the ray,\n"
    "  ray t x y z nx ny nz u v k1 k2 instance face name\n"
    "ray: number of the input line, from 0; t: in lengths of the given direction; n: outward normal; k1, k2: principal curvatures (nan "
    "where\n"
    "there are none); name: the face's, '-' if it has none, blanks as _. A ray without hits gives 'ray miss'.";

}  // namespace

void add_hit_command(CLI::App& app, Exit& exit) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("hit", "rays on standard input, their hits on standard output, in double precision");
  command->footer(kHitHelp);
  command->add_option("MODEL", options->model, "STEP, IGES, BREP, OBJ, BPT, IPATCH, GBP, LOP or MP file")->required();
  declare_patches_option(*command, options->patches);
  command->add_flag("--nearest", options->nearest, "only the nearest hit: exactly one line per ray");
  command->add_flag("--json", options->json, "one JSON object a line");
  command->add_option("-t,--threads", options->threads, "threads to use; 0: all [0]")->check(CLI::Range(0, 1024));
  command->add_flag("--stats", options->stats, "all counters of the build and the solver when done");
  command->callback([options, &exit] { exit = hit(*options); });
}

}  // namespace iso
