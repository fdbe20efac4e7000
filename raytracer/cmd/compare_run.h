// The work of `compare`: a model's exact surfaces, measured and pictured against meshes, one after the other.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "raytracer/cmd/compare_options.h"
#include "raytracer/cmd/compare_report.h"
#include "raytracer/cmd/compare_words.h"
#include "raytracer/cmd/interrupt.h"
#include "raytracer/cmd/load_models.h"
#include "raytracer/cmd/scene_mesh.h"
#include "raytracer/progress.h"

namespace iso {

// A file of the report's folder.
struct ReportFile {
  std::string name, bytes;
};

class CompareRun {
 public:
  CompareRun(const CompareOptions& options, int threads);
  ~CompareRun();

  // The whole comparison. The pictures' EXR files are handed to `keep` as they come, so that they need not be held. An
  // interrupt ends it with Exit::interrupted, once the input is read; what comes after it, as long as this lives, is not interrupted.
  Result<CompareReport> run(const std::function<Status(const ReportFile&)>& keep);

 private:
  struct Scene;
  Status compare_all();
  Status load();
  Status check_request();
  Status start_pictures();
  Status compare_ours(const Tolerance& tolerance, bool pictures, const std::optional<PatternSettings>& pattern = {});
  Status compare_strategies();
  Status compare_theirs(ForeignMesh triangles);
  Status compare(ReportMesh& mesh, const ForeignMesh& triangles, const TraceScene& scene, bool pictures);
  Status add_pictures(ReportMesh& mesh, const ForeignMesh& triangles, const TraceScene& scene);
  Status advise();
  Status fail_limits();
  void go_on(int done, int all);
  Result<double> length(const std::string& text, const char* option) const;

  const CompareOptions& options_;
  int threads_;
  const std::function<Status(const ReportFile&)>* keep_ = nullptr;
  std::unique_ptr<Scene> scene_;
  std::vector<Tolerance> tolerances_;
  std::vector<ForeignMesh> meshes_;
  double reference_ = 0;
  InterruptGuard interrupt_;
  Progress progress_;
  FailLimits limits_;
  CompareReport report_;
};

}  // namespace iso
