#include "patches/io/occt_shape.h"

#include <fmt/format.h>

#include <BRep_Tool.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedDataMapOfShapeListOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Iterator.hxx>

#include "patches/io/occt_face.h"

namespace iso::occt {
namespace {

// Locations may mirror and scale: faces and instances know what to do with them.
constexpr Standard_Boolean kAnyLocation = Standard_False;

Affine3 to_affine(const gp_Trsf& t) {
  Affine3 a;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) a.linear[column][row] = t.Value(row + 1, column + 1);
    a.translation[row] = t.Value(row + 1, 4);
  }
  return a;
}

// Every edge that is not a point is used an even number of times: the solid has an inside.
bool is_closed(const TopoDS_Shape& solid) {
  std::unordered_map<const TopoDS_TShape*, int> uses;
  for (TopExp_Explorer e(solid, TopAbs_EDGE); e.More(); e.Next()) {
    const TopoDS_Edge& edge = TopoDS::Edge(e.Current());
    if (!BRep_Tool::Degenerated(edge) && edge.Orientation() != TopAbs_INTERNAL) ++uses[edge.TShape().get()];
  }
  return std::all_of(uses.begin(), uses.end(), [](const auto& use) { return use.second % 2 == 0; });
}

int count(const TopoDS_Shape& shape, TopAbs_ShapeEnum what, TopAbs_ShapeEnum outside) {
  int n = 0;
  for (TopExp_Explorer e(shape, what, outside); e.More(); e.Next()) ++n;
  return n;
}

bool is_reversed(const TopoDS_Shape& shape) { return shape.Orientation() == TopAbs_REVERSED; }

}  // namespace

void FaceStyles::colour(const TopoDS_Shape& shape, const Colour& colour) {
  for (TopExp_Explorer f(shape, TopAbs_FACE); f.More(); f.Next()) colours[f.Current().TShape().get()] = colour;
}
void FaceStyles::name(const TopoDS_Shape& shape, const std::string& name) {
  for (TopExp_Explorer f(shape, TopAbs_FACE); f.More(); f.Next()) names[f.Current().TShape().get()] = name;
}

ModelBuilder::ModelBuilder(std::string file, std::string format) {
  model.file = std::move(file);
  model.format = std::move(format);
}

ModelBuilder::Body ModelBuilder::body_of(const TopoDS_Shape& shape) {
  return {{shape.TShape().get(), is_reversed(shape)}, shape.Location(), {shape.Located(TopLoc_Location(), kAnyLocation)}};
}

void ModelBuilder::collect_bodies(const TopoDS_Shape& shape, std::vector<Body>& bodies) {
  const TopAbs_ShapeEnum type = shape.ShapeType();
  if (type == TopAbs_SOLID || type == TopAbs_SHELL || type == TopAbs_FACE) {
    bodies.push_back(body_of(shape));
    return;
  }
  if (type > TopAbs_FACE) return;  // wires, edges, vertices
  Body loose{{shape.TShape().get(), is_reversed(shape)}, shape.Location(), {}};
  for (TopoDS_Iterator it(shape.Located(TopLoc_Location(), kAnyLocation)); it.More(); it.Next()) {
    if (it.Value().ShapeType() == TopAbs_FACE)
      loose.shapes.push_back(it.Value());
    else
      collect_bodies(it.Value().Located(shape.Location() * it.Value().Location(), kAnyLocation), bodies);
  }
  if (!loose.shapes.empty()) bodies.push_back(std::move(loose));
}

// One part of all faces of the bodies, in the frame of the first ones' parent (`placed`) or in that of the single body.
int ModelBuilder::make_part(const std::vector<Body>& bodies, bool placed, const std::string& name, const FaceStyles& styles) {
  PartInProgress progress;
  progress.part.name = name;
  for (const Body& body : bodies)
    for (const TopoDS_Shape& bare : body.shapes) {
      const TopoDS_Shape shape = placed ? bare.Located(body.place * bare.Location(), kAnyLocation) : bare;
      int solid = -1;
      if (shape.ShapeType() == TopAbs_SOLID) {
        if (is_closed(shape))
          solid = progress.part.solids++;
        else
          model.report(Problem::Kind::note, fmt::format("solid of '{}'", name), "it is not closed: treated as a shell");
      }
      for (TopExp_Explorer f(shape, TopAbs_FACE); f.More(); f.Next()) {
        const TopoDS_TShape* id = f.Current().TShape().get();
        const auto named = styles.names.find(id);
        const std::string& face_name = named != styles.names.end() ? named->second : name;
        const std::string entity = fmt::format("face #{}{}", ++face_number_, face_name.empty() ? "" : " '" + face_name + "'");
        const auto report = [&](Problem::Kind kind, const std::string& what) { model.report(kind, entity, what); };
        if (!add_face(TopoDS::Face(f.Current()), solid, progress, report)) continue;
        const auto coloured = styles.colours.find(id);
        if (coloured != styles.colours.end()) progress.part.faces.back().colour = coloured->second;
        if (named != styles.names.end()) progress.part.faces.back().name = named->second;
      }
    }
  if (progress.part.faces.empty()) return -1;
  model.parts.push_back(std::move(progress.part));
  return static_cast<int>(model.parts.size()) - 1;
}

const std::vector<ModelBuilder::PlacedPart>& ModelBuilder::parts_of(const TopoDS_Shape& shape, const std::string& name,
                                                                    const FaceStyles& styles) {
  const Key key{shape.TShape().get(), is_reversed(shape)};
  const auto [known, is_new] = known_.try_emplace(key);
  if (!is_new) return known->second;
  alive_.push_back(shape);
  count_loose(shape);
  std::vector<Body> bodies, single;
  collect_bodies(shape, bodies);
  std::map<Key, int> times;
  for (const Body& body : bodies) ++times[body.key];
  // Bodies that are placed several times become parts of their own; all others together make one part.
  for (const Body& body : bodies) {
    if (times[body.key] == 1) {
      single.push_back(body);
      continue;
    }
    const auto [it, first] = known_bodies_.try_emplace(body.key, -1);
    if (first) it->second = make_part({body}, false, name, styles);
    if (it->second >= 0) known->second.push_back({it->second, body.place});
  }
  const int rest = single.empty() ? -1 : make_part(single, true, name, styles);
  if (rest >= 0) known->second.push_back({rest, TopLoc_Location()});
  return known->second;
}

void ModelBuilder::add(const TopoDS_Shape& shape, const TopLoc_Location& place, const std::string& shape_name,
                       const std::string& instance_name, const std::optional<Colour>& instance_colour, const FaceStyles& styles) {
  if (shape.IsNull()) return;
  const TopLoc_Location whole = place * shape.Location();
  for (const PlacedPart& placed : parts_of(shape.Located(TopLoc_Location(), kAnyLocation), shape_name, styles)) {
    const Affine3 to_model = to_affine((whole * placed.place).Transformation());
    if (std::abs(glm::determinant(to_model.linear)) > 0 && finite(to_model.translation))
      model.instances.push_back({placed.part, to_model, instance_colour, instance_name.empty() ? shape_name : instance_name});
    else
      model.report(Problem::Kind::dropped, fmt::format("instance '{}'", instance_name), "its placement is singular");
  }
}

void ModelBuilder::count_loose(const TopoDS_Shape& shape) {
  loose_wires_ += count(shape, TopAbs_WIRE, TopAbs_FACE);
  loose_edges_ += count(shape, TopAbs_EDGE, TopAbs_WIRE);
  loose_vertices_ += count(shape, TopAbs_VERTEX, TopAbs_EDGE);
}

Model ModelBuilder::take() {
  const auto tell = [&](int n, const char* what) {
    if (n > 0) model.report(Problem::Kind::note, "model", fmt::format("{} free {}{} bound no face: not used", n, what, n > 1 ? "s" : ""));
  };
  tell(loose_wires_, "wire");
  tell(loose_edges_, "edge");
  tell(loose_vertices_, "point");
  return std::move(model);
}

}  // namespace iso::occt
