// A CAD model as the program sees it: parts (faces on surfaces, trimmed by loops of parameter curves, and the edges they share)
// and placed instances of the parts. Readers make it; nothing here knows files or rendering.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "patches/base/affine.h"
#include "patches/surface/surface.h"

namespace iso {

// One piece of a trim loop: `curve` in the face's (u, v), run through from t0 to t1 (t0 > t1: against the parameter).
struct TrimCurve {
  Curve2 curve;
  double t0 = 0, t1 = 1;
  int edge = -1;  // index into Part::edges, or -1
};
struct TrimLoop {
  std::vector<TrimCurve> curves;  // end to end, closed
};

struct Face {
  AnySurface surface;
  std::vector<TrimLoop> loops;  // empty: the whole `domain` is the face [Safko 2022, 2.6]
  Box2 domain;                  // finite box of (u, v) that holds the face
  bool reversed = false;        // outward normal is -(Su x Sv)
  std::optional<Colour> colour;
  std::string name;
  int solid = -1;                  // number of the closed solid it belongs to, -1 for shells and loose faces
  double approximation_error = 0;  // world units; > 0 where the file's surface had to be approximated
};

struct Edge {
  int uses = 0;               // how many times faces use it (a seam counts twice)
  bool degenerate = false;    // a point in space (pole, apex)
  double file_tolerance = 0;  // as the file states
  double gap = 0;             // measured: largest distance between the curves that the uses trace on their surfaces; 0 for one use
  double closing = 0;         // points this far beyond a trim curve still belong to the face, so that no crack is left: the measured gap,
                              // at most the file's tolerance where the uses are not known to be one edge (see finish)
};

struct Part {
  std::string name;
  std::vector<Face> faces;
  std::vector<Edge> edges;
  int solids = 0;
  Box3 box;  // of the trimmed faces, guaranteed
};

struct Instance {
  int part = 0;
  Affine3 to_model;              // part coordinates to model coordinates
  std::optional<Colour> colour;  // used by faces that have none of their own
  std::string name;
};

// Something in the file that was mended, approximated, or could not be used. `count` equal ones are told once.
struct Problem {
  enum class Kind { note, repaired, approximated, dropped } kind = Kind::note;
  std::string entity, what;
  int count = 1;
};

struct Model {
  std::string file, format;  // "STEP", "IGES", "BREP", "OBJ", "BPT", "IPATCH", "GBP", "LOP", "MP"
  std::string file_unit;     // unit written in the file, may be empty
  std::string unit;          // unit of the coordinates here: "mm" for STEP and IGES, else ""
  std::vector<Part> parts;
  std::vector<Instance> instances;
  std::vector<Problem> problems;

  void report(Problem::Kind kind, std::string entity, std::string what);
};

// Moves each part's geometry so that it lies about its own origin and puts the shift into the instances, and measures the
// boxes and edge gaps: after it a part far from the origin is as precise as one at it. Every reader ends with it.
void finish(Model& model);

// The box of all instances in model coordinates.
Box3 box_of(const Model& model);

}  // namespace iso
