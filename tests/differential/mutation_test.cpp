// The comparison itself: it must see what is wrong with a mesh, or its silence means nothing.
#include <gtest/gtest.h>

#include "tests/differential/compare.h"
#include "tests/support/load.h"

namespace iso::test {
namespace {

constexpr ImageSize kSize{160, 120};

class Mutation : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    const std::string path = data("cad/occt-screw.step");
    mesh_ = new OcctMesh(mesh_with_occt(path, {}));
    tracer_ = new Tracer(tracer_of(load(path)));
  }
  static void TearDownTestSuite() {
    delete mesh_;
    delete tracer_;
  }

  static const OcctMesh& mesh() { return *mesh_; }
  static std::vector<Ray> rays() { return rays_from_above(mesh_->box, kSize); }
  static Picture picture_of(const OcctMesh& mutated) { return compare(mutated, *tracer_, rays(), kSize); }
  static OcctMesh moved(const Vec3& by) {
    OcctMesh mutated = mesh();
    for (Vec3& p : mutated.points) p += by;
    return mutated;
  }

 private:
  static inline OcctMesh* mesh_ = nullptr;
  static inline Tracer* tracer_ = nullptr;
};

TEST_F(Mutation, NothingIsFoundInTheMeshAsItIs) {
  const Picture p = picture_of(mesh());
  EXPECT_GT(p.hits, 1000);
  EXPECT_EQ(p.hit_miss_off_rim + p.depth_off_rim, 0);
  EXPECT_LE(p.hit_miss + p.depth, 0.001 * double(p.pixels.size()));
}

TEST_F(Mutation, AMeshPushedAlongTheRaysByFifteenDeflectionsIsFoundAtNearlyAllPixelsThatFaceThem) {
  // Six are allowed at 60 degrees; a shift sideways by three may explain five more there.
  const Picture p = picture_of(moved(15 * mesh().deflection * rays()[0].d));
  long facing = 0, found = 0;
  for (const PixelPair& pixel : p.pixels) {
    const bool is_facing = pixel.ours && pixel.theirs && pixel.allowed < 2 * pixel.off;
    facing += is_facing;
    found += is_facing && pixel.verdict == Verdict::depth;
  }
  EXPECT_GT(facing, 500);
  EXPECT_GT(double(found), 0.99 * double(facing)) << "the rest lies beside edges";
}

TEST_F(Mutation, AMeshMovedSidewaysByTwoPixelsIsFoundOnBothSides) {
  const std::vector<Ray> all = rays();
  const Picture p = picture_of(moved(2.0 * (all[1].o - all[0].o)));
  long only_ours = 0, only_theirs = 0;
  for (const PixelPair& pixel : p.pixels) {
    only_ours += pixel.verdict == Verdict::hit_miss && pixel.ours;
    only_theirs += pixel.verdict == Verdict::hit_miss && pixel.theirs;
  }
  EXPECT_GT(only_ours, 50);
  EXPECT_GT(only_theirs, 50);
}

TEST_F(Mutation, EachFaceThatIsSeenIsMissedWhenTheMeshIsWithoutIt) {
  const Picture whole = picture_of(mesh());
  int seen_faces = 0;
  for (int face = 0; face < mesh().faces; ++face) {
    long seen = 0;
    for (const PixelPair& pixel : whole.pixels) seen += pixel.theirs && pixel.their_face == face;
    if (seen < 50) continue;
    OcctMesh mutated = mesh();
    std::erase_if(mutated.triangles, [&](const MeshTriangle& t) { return t.face == face; });
    const Picture p = picture_of(mutated);
    EXPECT_GT(double(p.hit_miss_off_rim + p.depth_off_rim), 0.9 * double(seen)) << "face " << face;
    ++seen_faces;
  }
  EXPECT_GE(seen_faces, 3);
}

}  // namespace
}  // namespace iso::test
