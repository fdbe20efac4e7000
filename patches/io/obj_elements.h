// What an OBJ file says about free-form surfaces, before anything is built from it: points and elements with their lines.
// Alias|Wavefront's format; `statements` of no use for surfaces are counted.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "patches/base/vec.h"

namespace iso {

// `cstype` and `deg` as they stand when an element begins.
struct ObjAttributes {
  std::string type;  // "bezier", "bspline", ...; empty: not stated
  bool rational = false;
  int degree_u = 0, degree_v = 0;

  bool supported() const { return type == "bezier" || type == "bspline"; }
};

// A piece of a loop: trim curve number `curve` (from 0) from t0 to t1.
struct ObjLoopPiece {
  double t0, t1;
  long curve;
};
struct ObjLoop {
  int line = 0;
  bool hole = false;
  std::vector<ObjLoopPiece> pieces;
};
struct ObjElement {
  enum class Kind { none, surface, trim_curve, other } kind = Kind::none;
  int line = 0;
  ObjAttributes attributes;
  std::string keyword, name;
  Range u, v;                // surface: its domain
  std::vector<long> points;  // from 0
  std::vector<double> parm_u, parm_v;
  std::vector<ObjLoop> loops;
};

// A polygon of a control mesh: indices of vertices and, if every corner has one, of normals, from 0.
struct ObjPolygon {
  int line = 0;
  std::vector<long> points, normals;
  std::string name;  // of its object and group
};

// A statement kind that is counted instead of used.
struct ObjCounted {
  int first_line = 0, count = 0;
};

struct ObjFile {
  std::vector<Vec4> vertices;            // x y z weight
  std::vector<Vec3> parameter_vertices;  // u v weight
  std::vector<ObjElement> surfaces, trim_curves;
  std::vector<Vec3> normals;
  std::vector<ObjPolygon> polygons;           // if they are to be read; else counted
  std::map<std::string, ObjCounted> counted;  // by keyword; "" for those that are not known
  std::string first_unknown;                  // quoted
  int lines = 0;
};

// Throws an `Error` (see text_input.h) for malformed text. References to points and curves that do not exist are found when used.
enum class PolygonsOfObj { counted, read };
ObjFile parse_obj(const std::string& path, std::string_view text, PolygonsOfObj polygons = PolygonsOfObj::counted);

}  // namespace iso
