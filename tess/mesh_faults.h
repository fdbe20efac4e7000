// Names what is wrong with a mesh from what was measured of it.
#pragma once

#include <string>
#include <vector>

#include "tess/mesh_comparison.h"

namespace iso {

// What was measured of one triangle of the mesh, at its middle.
struct TriangleFinding {
  std::uint32_t face = 0;  // the exact face that is nearest
  float angle = 0;         // radians, between the triangle and that face; 0 for a triangle without area
  float area = 0;
  double distance = 0;  // from the faces
  std::uint32_t reference = TriangleTree::kNone;
  bool inward = false;  // shows its back outside
};

struct PointFinding {
  double distance = 0;  // from the faces
  std::uint32_t reference = TriangleTree::kNone;
  Vec3 normal{0.0};  // of the face there
};

struct FaultInput {
  const ExactFaces& faces;
  const ForeignMesh& mesh;
  const ComparisonSettings& settings;
  const std::vector<TriangleFinding>& triangles;
  const std::vector<PointFinding>& points;
  const std::vector<float>& nearest_of_triangle;
  const std::vector<OpenEdge>& cracks;  // open edges where the model is closed
  std::vector<double> missing_shares;   // of each face: the share of its area that is farther than `far`
  double far = 0;                       // well beyond what is usual for this mesh
  double far_point = 0;                 // the same for its points
};

// Size, units and place, from the boxes of both; at most one.
std::vector<FaultFound> faults_of_place(const Box3& model, const Box3& mesh, const std::string& unit);

// All others.
std::vector<FaultFound> faults_of_mesh(const FaultInput& input, const MeshComparison& measured);

}  // namespace iso
