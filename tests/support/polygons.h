// Polygons of Wavefront files as they are, for tests and benchmarks.
#pragma once

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "patches/base/check.h"
#include "patches/base/vec.h"

namespace iso::test {

struct PolygonMesh {
  std::vector<Vec3> points;
  std::vector<std::vector<int>> polygons;  // counter-clockwise seen from outside
};

// The lines `v` and `f` of a Wavefront file, as they are.
inline PolygonMesh read_polygons(const std::string& path) {
  PolygonMesh mesh;
  std::ifstream file(path);
  ISO_CHECK(file.good());
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "v") {
      Vec3 p;
      words >> p.x >> p.y >> p.z;
      mesh.points.push_back(p);
    } else if (word == "f") {
      mesh.polygons.emplace_back();
      while (words >> word) mesh.polygons.back().push_back(std::stoi(word) - 1);
    }
  }
  return mesh;
}

}  // namespace iso::test
