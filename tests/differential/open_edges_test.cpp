// The verifier's open edges against admesh's, on meshes that are not ours: Open CASCADE's of real models, good and bad ones.
#include <gtest/gtest.h>

#include "patches/io/write_mesh.h"
#include "tess/verify.h"
#include "tests/support/child.h"
#include "tests/support/occt_mesh.h"

namespace iso::test {
namespace {

// As a part of one face, in float: admesh joins the places that a binary STL holds.
struct Bare {
  Model model;
  ModelMesh mesh;
  std::vector<PointTriangle> joined;
};
Bare bare(const OcctMesh& theirs) {
  Bare b;
  b.model.parts.resize(1);
  b.model.parts[0].faces.resize(1);
  b.model.instances.resize(1);
  PartMesh& mesh = b.mesh.parts.emplace_back();
  for (const Vec3& p : theirs.points) {
    mesh.nodes.push_back({static_cast<std::uint32_t>(mesh.points.size()), UV(0), Vec3(0)});
    mesh.points.emplace_back(glm::vec3(p));
  }
  const std::vector<std::uint32_t> first = joined_points(mesh.points);
  for (const MeshTriangle& t : theirs.triangles) {
    mesh.triangles.push_back(t.corners);
    b.joined.push_back({first[t.corners[0]], first[t.corners[1]], first[t.corners[2]]});
  }
  mesh.first_node.push_back(static_cast<std::uint32_t>(mesh.nodes.size()));
  mesh.first_triangle.push_back(static_cast<std::uint32_t>(mesh.triangles.size()));
  return b;
}

TEST(VerifyRealMeshes, OpenEdgesAreAsManyAsAdmeshFinds) {
  const std::string admesh = "/usr/bin/admesh";
  ASSERT_TRUE(std::filesystem::exists(admesh)) << "admesh is not installed";
  const TemporaryDir dir;
  const std::string file = (dir.path() / "mesh.stl").string();
  std::uint64_t open = 0, closed = 0;
  for (const char* name : {"occt-screw.step", "axom-sliced-cylinder.step", "occt-crank-arm.brep", "dealii-dtmb-5415-bulbous-bow.iges",
                           "nist-mbe-pmi-11.stp"}) {
    const Bare b = bare(mesh_with_occt(data(std::string("cad/") + name), {1e-3, 0.3}));
    const TopologyReport report = check_topology(b.mesh.parts[0].points, b.joined);
    ASSERT_TRUE(write_mesh(file, b.model, b.mesh));
    const ChildResult told = run_child({admesh, file});
    ASSERT_EQ(told.code, 0) << told.summary();
    const auto count = [&](const std::string& words) {
      const std::size_t at = told.out.find(words);
      if (at == std::string::npos) throw std::runtime_error("admesh does not say: " + words);
      return std::stoul(told.out.substr(at + words.size()));
    };
    const auto theirs = count("Facets with 1 disconnected edge  :") + 2 * count("Facets with 2 disconnected edges :") +
                        3 * count("Facets with 3 disconnected edges :");
    EXPECT_EQ(report.open_edges.count, theirs) << name << "\n" << text_of(report) << told.out;
    EXPECT_EQ(report.zero_area.count, count("Degenerate facets     :")) << name;
    open += report.open_edges.count;
    closed += report.open_edges.count == 0;
  }
  EXPECT_GT(open, 50u) << "some must be open, or the comparison says little";
  EXPECT_GT(closed, 1u);
}

}  // namespace
}  // namespace iso::test
