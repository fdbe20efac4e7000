#include "tess/orient.h"

#include <algorithm>

namespace iso {

namespace {

// A side of a triangle between two faces' points, the smaller point first.
struct Side {
  std::uint32_t a, b;
  std::uint32_t face;
  bool forward;  // run through from a to b
};

std::vector<Side> sides_of(const PartMesh& mesh) {
  std::vector<Side> sides;
  sides.reserve(3 * mesh.triangles.size());
  for (int f = 0; f < mesh.face_count(); ++f)
    for (std::uint32_t i = mesh.first_triangle[static_cast<std::size_t>(f)]; i < mesh.first_triangle[static_cast<std::size_t>(f) + 1]; ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t p = mesh.nodes[mesh.triangles[i][k]].point, q = mesh.nodes[mesh.triangles[i][(k + 1) % 3]].point;
        sides.push_back({std::min(p, q), std::max(p, q), static_cast<std::uint32_t>(f), p < q});
      }
  std::sort(sides.begin(), sides.end(), [](const Side& x, const Side& y) {
    if (x.a != y.a) return x.a < y.a;
    if (x.b != y.b) return x.b < y.b;
    return x.face < y.face;
  });
  return sides;
}

struct Neighbour {
  std::uint32_t face;
  bool agrees;
};
struct Shells {
  std::vector<std::vector<Neighbour>> neighbours;  // of each face
  std::vector<bool> open;                          // faces with a side that has no partner
};

Shells shells_of(const PartMesh& mesh) {
  const auto count = static_cast<std::size_t>(mesh.face_count());
  Shells shells{std::vector<std::vector<Neighbour>>(count), std::vector<bool>(count, false)};
  const std::vector<Side> sides = sides_of(mesh);
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t j = i + 1;
    while (j < sides.size() && sides[j].a == sides[i].a && sides[j].b == sides[i].b) ++j;
    const Side &x = sides[i], &y = sides[j - 1];
    if (j - i != 2) {
      for (std::size_t k = i; k < j; ++k) shells.open[sides[k].face] = true;
    } else if (x.face != y.face) {
      shells.neighbours[x.face].push_back({y.face, x.forward != y.forward});
      shells.neighbours[y.face].push_back({x.face, x.forward != y.forward});
    }
    i = j;
  }
  return shells;
}

// Six times the volume between a face and the origin.
double volume_of(const PartMesh& mesh, std::size_t face) {
  double volume = 0;
  for (std::uint32_t i = mesh.first_triangle[face]; i < mesh.first_triangle[face + 1]; ++i) {
    const Triangle& t = mesh.triangles[i];
    volume += glm::dot(mesh.corner(t, 0), glm::cross(mesh.corner(t, 1), mesh.corner(t, 2)));
  }
  return volume;
}

// One connected shell: its faces, and on which of two sides each looks, told from the first.
struct Shell {
  std::vector<std::uint32_t> faces;
  bool agree = true, closed = true;
  int conflicts = 0;
};
Shell walk(const Shells& shells, std::uint32_t start, std::vector<std::int8_t>& look) {
  Shell shell;
  shell.faces.push_back(start);
  look[start] = 1;
  for (std::size_t i = 0; i < shell.faces.size(); ++i) {
    const std::uint32_t f = shell.faces[i];
    shell.closed = shell.closed && !shells.open[f];
    for (const Neighbour& n : shells.neighbours[f]) {
      const auto wanted = static_cast<std::int8_t>(n.agrees ? look[f] : -look[f]);
      if (look[n.face] == 0) {
        look[n.face] = wanted;
        shell.agree = shell.agree && n.agrees;
        shell.faces.push_back(n.face);
      } else if (look[n.face] != wanted) {
        ++shell.conflicts;
      }
    }
  }
  for (std::uint32_t f : shell.faces) shell.agree = shell.agree && look[f] == 1;
  shell.conflicts /= 2;
  return shell;
}

}  // namespace

Orientation orient(const PartMesh& mesh) {
  const auto count = static_cast<std::size_t>(mesh.face_count());
  const Shells shells = shells_of(mesh);
  Orientation result{std::vector<bool>(count, false), 0, 0};
  std::vector<std::int8_t> look(count, 0);
  for (std::uint32_t start = 0; start < count; ++start) {
    if (look[start] != 0) continue;
    const Shell shell = walk(shells, start, look);
    result.conflicts += shell.conflicts;
    if (shell.agree) continue;
    double volume = 0;
    std::size_t minus = 0;
    for (std::uint32_t f : shell.faces) {
      volume += look[f] * volume_of(mesh, f);
      minus += look[f] < 0;
    }
    const bool turn_plus = shell.closed ? volume < 0 : 2 * minus > shell.faces.size();
    for (std::uint32_t f : shell.faces)
      if ((look[f] > 0) == turn_plus) {
        result.turned[f] = true;
        ++result.count;
      }
  }
  return result;
}

void turn(PartMesh& mesh, const std::vector<bool>& faces) {
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (!faces[f]) continue;
    for (std::uint32_t i = mesh.first_triangle[f]; i < mesh.first_triangle[f + 1]; ++i)
      std::swap(mesh.triangles[i][1], mesh.triangles[i][2]);
    for (std::uint32_t i = mesh.first_node[f]; i < mesh.first_node[f + 1]; ++i) mesh.nodes[i].normal = -mesh.nodes[i].normal;
  }
}

}  // namespace iso
