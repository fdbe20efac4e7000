// Every model at hand, meshed at several tolerances: what its mesh must keep (tests/support/tessellation_check.h), told as a table.
#include <gtest/gtest.h>

#include <ctime>

#include "tests/support/load.h"
#include "tests/support/tessellation_check.h"
#include "tests/support/wanted.h"

namespace iso::test {
namespace {

// Files that hold nothing to mesh.
bool has_no_faces(const Error& error) { return error.text().find("no faces that can be used") != std::string::npos; }

double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

struct Survey {
  int files = 0, parts = 0, faces = 0, defects = 0;
  std::size_t triangles = 0;
};

void survey_part(const std::string& file, const Part& part, int number, double share, double tolerance, Survey& survey) {
  constexpr double kMostSeconds = 60;
  const int samples = static_cast<int>(wanted("ISOPHOTE_MESH_SAMPLES", 30));
  Random random(1);
  const double start = cpu_seconds();
  const PartTessellation made = tessellate(part, {tolerance});
  EXPECT_LE(cpu_seconds() - start, kMostSeconds) << file << " at " << share;
  ++survey.parts;
  survey.faces += static_cast<int>(part.faces.size());
  survey.triangles += made.mesh.triangles.size();
  for (Defect& d : defects_of(part, made, tolerance, samples, random)) {
    d.part = number;
    ++survey.defects;
    ADD_FAILURE() << fmt::format("{} {:.0e} {}", file, share, text_of(d));
  }
}

void survey_models(const std::vector<double>& shares, int least_files) {
  if (!shared_data_dir()) GTEST_LOG_(INFO) << "ISOPHOTE_DATA is not set: the models of the source tree only";
  if (!occt_data_dir()) GTEST_LOG_(INFO) << "no models of the package occt-misc";
  Survey survey;
  for (const auto& path : cad_models()) {
    const auto model = read_model(path.string());
    if (!model) {
      EXPECT_TRUE(has_no_faces(model.error())) << model.error().text();
      continue;
    }
    ++survey.files;
    for (const double share : shares)
      for (std::size_t p = 0; p < model->parts.size(); ++p)
        survey_part(path.filename().string(), model->parts[p], static_cast<int>(p), share, share * box_of(*model).diagonal(), survey);
  }
  GTEST_LOG_(INFO) << fmt::format("{} files, {} parts, {} faces, {} triangles, {} defects", survey.files, survey.parts, survey.faces,
                                  survey.triangles, survey.defects);
  EXPECT_GE(survey.files, least_files);
  EXPECT_EQ(survey.defects, 0);
}

constexpr int kLeastFiles = 50;

TEST(TessellateModels, KeepTheirPromises) { survey_models({1e-2, 1e-3}, kLeastFiles); }
TEST(TessellateModelsSlow, KeepTheirPromisesAtATenThousandth) { survey_models({1e-4}, kLeastFiles); }

}  // namespace
}  // namespace iso::test
