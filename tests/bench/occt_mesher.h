// Open CASCADE's BRepMesh as a rival: a shape read once and meshed again and again with either of its triangulators, one thread, by the
// chordal deviation alone (the angular one is switched off).
#pragma once

#include <memory>
#include <string>

#include "tests/bench/mesh_deviation.h"

namespace iso::bench {

enum class OcctAlgorithm { watson, delabella };

class OcctMesher {
 public:
  explicit OcctMesher(const std::string& path);  // throws test::OcctFailure
  ~OcctMesher();
  OcctMesher(OcctMesher&&) noexcept;

  int faces() const;
  const char* kind_of(int face) const;  // of its surface
  double diagonal() const;              // of the tight box of the shape

  // CPU seconds of meshing, done afresh; `distance` is in the units of the shape.
  double mesh(double distance, OcctAlgorithm algorithm);

  // The mesh of the last call with its points joined along the shape's edges and at poles, by index, not by place.
  PartMesh result() const;
  MeasuredSurfaces surfaces() const;  // as long as this lives

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace iso::bench
