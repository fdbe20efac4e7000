#include "tests/bench/occt_mesher.h"

#include <BRepAdaptor_Surface.hxx>
#include <BRepBndLib.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <IMeshTools_Parameters.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Poly_PolygonOnTriangulation.hxx>
#include <Poly_Triangulation.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Vertex.hxx>
#include <numeric>
#include <unordered_map>

#include "tests/bench/timing.h"
#include "tests/support/occt_shape.h"

namespace iso::bench {

struct OcctMesher::Impl {
  TopoDS_Shape shape;
  TopTools_IndexedMapOfShape faces, edges, vertices;
  std::vector<BRepAdaptor_Surface> surfaces;
  double diagonal = 0;

  const TopoDS_Face& face(int i) const { return TopoDS::Face(faces(i + 1)); }
};

namespace {

Vec3 vec(const gp_XYZ& p) { return {p.X(), p.Y(), p.Z()}; }

// Numbers that are found to be one.
class Unions {
 public:
  explicit Unions(std::size_t count) : next_(count) { std::iota(next_.begin(), next_.end(), std::uint32_t{0}); }
  std::uint32_t root(std::uint32_t i) {
    while (next_[i] != i) i = next_[i] = next_[next_[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) { next_[root(a)] = root(b); }

 private:
  std::vector<std::uint32_t> next_;
};

using Triangulation = Handle(Poly_Triangulation);

Triangulation triangulation_of(const TopoDS_Face& face, TopLoc_Location& place) { return BRep_Tool::Triangulation(face, place); }

MeshNode node_of(const BRepAdaptor_Surface& surface, const gp_Pnt2d& uv, bool reversed) {
  gp_Pnt p;
  gp_Vec du, dv;
  surface.D1(uv.X(), uv.Y(), p, du, dv);
  const Vec3 n = glm::cross(vec(du.XYZ()), vec(dv.XYZ()));
  const double length = glm::length(n);
  return {0, {uv.X(), uv.Y()}, length > 0 ? n * ((reversed ? -1 : 1) / length) : Vec3(0.0)};
}

}  // namespace

OcctMesher::OcctMesher(const std::string& path) : impl_(std::make_unique<Impl>()) {
  Message::DefaultMessenger()->ChangePrinters().Clear();  // its chatter
  impl_->shape = test::read_occt_shape(path);
  TopExp::MapShapes(impl_->shape, TopAbs_FACE, impl_->faces);
  TopExp::MapShapes(impl_->shape, TopAbs_EDGE, impl_->edges);
  TopExp::MapShapes(impl_->shape, TopAbs_VERTEX, impl_->vertices);
  for (int f = 0; f < faces(); ++f) impl_->surfaces.emplace_back(impl_->face(f), Standard_False);
  Bnd_Box box;
  BRepBndLib::AddOptimal(impl_->shape, box, Standard_False, Standard_False);
  if (box.IsVoid()) throw test::OcctFailure("Open CASCADE finds nothing that has a size");
  impl_->diagonal = std::sqrt(box.SquareExtent());
}
OcctMesher::~OcctMesher() = default;
OcctMesher::OcctMesher(OcctMesher&&) noexcept = default;

int OcctMesher::faces() const { return impl_->faces.Extent(); }
double OcctMesher::diagonal() const { return impl_->diagonal; }

const char* OcctMesher::kind_of(int face) const {
  constexpr const char* kNames[] = {"plane",    "cylinder",   "cone",      "sphere", "torus", "Bezier",
                                    "B-spline", "revolution", "extrusion", "offset", "other"};  // as in GeomAbs_SurfaceType
  return kNames[std::min<std::size_t>(impl_->surfaces[static_cast<std::size_t>(face)].GetType(), std::size(kNames) - 1)];
}

double OcctMesher::mesh(double distance, OcctAlgorithm algorithm) {
  constexpr double kAngleOff = 10;  // radians
  BRepTools::Clean(impl_->shape);
  IMeshTools_Parameters parameters;
  parameters.Deflection = distance;
  parameters.Angle = kAngleOff;
  parameters.InParallel = Standard_False;
  parameters.MeshAlgo = algorithm == OcctAlgorithm::watson ? IMeshTools_MeshAlgoType_Watson : IMeshTools_MeshAlgoType_Delabella;
  return seconds_of([&] { const BRepMesh_IncrementalMesh mesher(impl_->shape, parameters); });
}

namespace {

// Which nodes of all faces are one point: those with the same place along an edge, at a vertex, or along an edge without length.
class NodeUnions {
 public:
  NodeUnions(const TopTools_IndexedMapOfShape& edges, const TopTools_IndexedMapOfShape& vertices, std::uint32_t nodes)
      : edges_(edges),
        vertices_(vertices),
        nodes_(nodes),
        known_(static_cast<std::size_t>(edges.Extent()) + 1),
        unions_(nodes + static_cast<std::size_t>(vertices.Extent()) + 1) {}

  void take(const TopoDS_Face& face, const Triangulation& triangulation, const TopLoc_Location& place, std::uint32_t first) {
    for (TopExp_Explorer it(face, TopAbs_EDGE); it.More(); it.Next()) {
      const TopoDS_Edge& edge = TopoDS::Edge(it.Current());
      const Handle(Poly_PolygonOnTriangulation) polygon = BRep_Tool::PolygonOnTriangulation(edge, triangulation, place);
      if (polygon.IsNull()) continue;
      std::vector<std::uint32_t> line;
      for (int i = 1; i <= polygon->NbNodes(); ++i) line.push_back(first + static_cast<std::uint32_t>(polygon->Node(i) - 1));
      take(edge, line);
    }
  }
  std::uint32_t root(std::uint32_t node) { return unions_.root(node); }

 private:
  void take(const TopoDS_Edge& edge, const std::vector<std::uint32_t>& line) {
    TopoDS_Vertex begin, end;
    TopExp::Vertices(TopoDS::Edge(edge.Oriented(TopAbs_FORWARD)), begin, end);
    if (!begin.IsNull()) unions_.join(line.front(), nodes_ + static_cast<std::uint32_t>(vertices_.FindIndex(begin)));
    if (!end.IsNull()) unions_.join(line.back(), nodes_ + static_cast<std::uint32_t>(vertices_.FindIndex(end)));
    if (BRep_Tool::Degenerated(edge)) {
      for (const std::uint32_t node : line) unions_.join(node, line.front());
      return;
    }
    auto& known = known_[static_cast<std::size_t>(edges_.FindIndex(edge))];
    if (known.empty()) known = line;
    if (known.size() != line.size()) return;  // shows as open edges
    for (std::size_t i = 0; i < line.size(); ++i) unions_.join(line[i], known[i]);
  }

  const TopTools_IndexedMapOfShape &edges_, &vertices_;
  std::uint32_t nodes_;
  std::vector<std::vector<std::uint32_t>> known_;
  Unions unions_;
};

// The nodes and triangles of a face; points are numbered as nodes.
void add_face(PartMesh& mesh, const TopoDS_Face& face, const BRepAdaptor_Surface& surface) {
  TopLoc_Location place;
  const Triangulation triangulation = triangulation_of(face, place);
  const bool reversed = face.Orientation() == TopAbs_REVERSED;
  const auto first = static_cast<std::uint32_t>(mesh.nodes.size());
  for (int i = 1; !triangulation.IsNull() && i <= triangulation->NbNodes(); ++i) {
    ISO_CHECK(triangulation->HasUVNodes());
    mesh.points.push_back(vec(triangulation->Node(i).Transformed(place.Transformation()).XYZ()));
    mesh.nodes.push_back(node_of(surface, triangulation->UVNode(i), reversed));
  }
  for (int i = 1; !triangulation.IsNull() && i <= triangulation->NbTriangles(); ++i) {
    std::array<int, 3> n{};
    triangulation->Triangle(i).Get(n[0], n[1], n[2]);
    if (reversed) std::swap(n[1], n[2]);
    Triangle& t = mesh.triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) t[k] = first + static_cast<std::uint32_t>(n[k] - 1);
  }
  mesh.first_node.push_back(static_cast<std::uint32_t>(mesh.nodes.size()));
  mesh.first_triangle.push_back(static_cast<std::uint32_t>(mesh.triangles.size()));
}

}  // namespace

PartMesh OcctMesher::result() const {
  PartMesh mesh;
  for (int f = 0; f < faces(); ++f) add_face(mesh, impl_->face(f), impl_->surfaces[static_cast<std::size_t>(f)]);
  NodeUnions unions(impl_->edges, impl_->vertices, static_cast<std::uint32_t>(mesh.nodes.size()));
  for (int f = 0; f < faces(); ++f) {
    TopLoc_Location place;
    const Triangulation triangulation = triangulation_of(impl_->face(f), place);
    if (!triangulation.IsNull()) unions.take(impl_->face(f), triangulation, place, mesh.first_node[static_cast<std::size_t>(f)]);
  }
  std::vector<Point3> points;
  std::unordered_map<std::uint32_t, std::uint32_t> number;
  for (std::uint32_t i = 0; i < mesh.nodes.size(); ++i) {
    const auto [known, is_new] = number.try_emplace(unions.root(i), static_cast<std::uint32_t>(points.size()));
    if (is_new) points.push_back(mesh.points[i]);
    mesh.nodes[i].point = known->second;
  }
  mesh.points = std::move(points);
  return mesh;
}

MeasuredSurfaces OcctMesher::surfaces() const {
  MeasuredSurfaces surfaces;
  for (const BRepAdaptor_Surface& surface : impl_->surfaces) surfaces.flat.push_back(surface.GetType() == GeomAbs_Plane);
  surfaces.point = [all = &impl_->surfaces](int face, const UV& uv) {
    return vec((*all)[static_cast<std::size_t>(face)].Value(uv.x, uv.y).XYZ());
  };
  return surfaces;
}

}  // namespace iso::bench
