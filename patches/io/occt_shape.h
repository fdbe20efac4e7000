// Shapes of Open CASCADE as parts and instances: what is placed several times is stored once.
#pragma once

#include <TopLoc_Location.hxx>
#include <TopoDS_Shape.hxx>
#include <map>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "patches/brep.h"

namespace iso::occt {

// Colours and names that the file gives to faces; keys are the faces' TShapes, which live as long as the shape.
struct FaceStyles {
  std::unordered_map<const TopoDS_TShape*, Colour> colours;
  std::unordered_map<const TopoDS_TShape*, std::string> names;

  // Gives the colour or name to every face of the shape.
  void colour(const TopoDS_Shape& shape, const Colour& colour);
  void name(const TopoDS_Shape& shape, const std::string& name);
};

class ModelBuilder {
 public:
  explicit ModelBuilder(std::string file, std::string format);

  // Adds an instance of the shape; its parts are made on first sight (styles and name are those of the shape, not of the instance).
  // `place` goes before the shape's own location.
  void add(const TopoDS_Shape& shape, const TopLoc_Location& place, const std::string& shape_name, const std::string& instance_name,
           const std::optional<Colour>& instance_colour, const FaceStyles& styles);

  // The finished model; tells what was in the file besides faces.
  Model take();

  Model model;

 private:
  // What is stored once: the TShape and whether it is turned inside out.
  using Key = std::pair<const TopoDS_TShape*, bool>;

  // A solid, a shell outside solids, or the loose faces of one compound.
  struct Body {
    Key key;
    TopLoc_Location place;
    std::vector<TopoDS_Shape> shapes;  // relative to `place`
  };
  struct PlacedPart {
    int part;
    TopLoc_Location place;
  };

  static void collect_bodies(const TopoDS_Shape& shape, std::vector<Body>& bodies);
  static Body body_of(const TopoDS_Shape& shape);
  const std::vector<PlacedPart>& parts_of(const TopoDS_Shape& shape, const std::string& name, const FaceStyles& styles);
  int make_part(const std::vector<Body>& bodies, bool placed, const std::string& name, const FaceStyles& styles);
  void count_loose(const TopoDS_Shape& shape);

  std::map<Key, std::vector<PlacedPart>> known_;  // of shapes
  std::map<Key, int> known_bodies_;               // -1: nothing in it could be used
  std::vector<TopoDS_Shape> alive_;               // TShapes whose addresses are keys
  int face_number_ = 0, loose_wires_ = 0, loose_edges_ = 0, loose_vertices_ = 0;
};

}  // namespace iso::occt
