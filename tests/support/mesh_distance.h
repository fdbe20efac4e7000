// The distance between a mesh and the exact faces it stands for, found by search alone: nearest points of triangles in a tree of boxes, and
// nearest points of surfaces by Newton steps from many starts. Nothing of the tessellator, its bounds or its own measuring takes part. All
// distances are of sampled points, so they are lower bounds of the largest distance.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "patches/brep.h"
#include "patches/triangle_mesh.h"
#include "tests/support/random_shapes.h"

namespace iso::test {

double distance_to_triangle(const Point3& p, const Point3& a, const Point3& b, const Point3& c);

// The nearest of many triangles to a point: a tree of boxes.
class TriangleTree {
 public:
  explicit TriangleTree(const PartMesh& mesh);
  double distance(const Point3& p) const;

 private:
  struct Node {
    Box3 box;
    std::uint32_t begin = 0, end = 0, right = 0;  // right 0: a leaf
  };
  void build(std::size_t begin, std::size_t end);
  void visit(std::size_t node, const Point3& p, double& best) const;

  std::vector<std::array<Point3, 3>> triangles_;
  std::vector<Node> nodes_;
};

// The distance of p from the face's surface near its domain: Newton steps from `start`, and where that leaves more than `enough`, from the
// best places of a dense search in `near` and in the whole domain. The surface is not cut off at the face's loops.
double distance_to_surface(const Face& face, const Point3& p, UV start, const Box2& near, double enough);

// A sample farther than it may be.
struct FarSample {
  int face = -1;
  bool to_mesh = false;  // a point of the surface from the mesh, else a point of a triangle from the surface
  UV uv{0.0};
  double distance = 0, allowed = 0;
};

struct DistanceSearch {
  std::uint64_t samples = 0;
  double worst_share = 0;         // of the allowed distance
  std::vector<FarSample> beyond;  // worst of each face and direction
};

// `allowed`: world units, of each face. Takes `samples` random points inside the loops of each face and as many in random triangles.
DistanceSearch search_distances(const Part& part, const PartMesh& mesh, const std::vector<double>& allowed, int samples, Random& random);

}  // namespace iso::test
