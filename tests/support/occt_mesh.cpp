#include "tests/support/occt_mesh.h"

#include <BRepAdaptor_Surface.hxx>
#include <BRepBndLib.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <IMeshData_Status.hxx>
#include <IMeshTools_Parameters.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <OSD_Chronometer.hxx>
#include <Poly_Triangulation.hxx>
#include <Standard_Failure.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Face.hxx>
#include <span>

#include "tests/support/occt_shape.h"

namespace iso::test {
namespace {

Vec3 vec(const gp_Pnt& p) { return {p.X(), p.Y(), p.Z()}; }

std::string mesh_shape(const TopoDS_Shape& shape, double deflection, double angle) {
  IMeshTools_Parameters parameters;
  parameters.Deflection = deflection;
  parameters.Angle = angle;
  const BRepMesh_IncrementalMesh mesher(shape, parameters);
  std::string status;
  const int flags = mesher.GetStatusFlags();
  constexpr std::pair<int, const char*> kNames[] = {{IMeshData_OpenWire, "open wire"},
                                                    {IMeshData_SelfIntersectingWire, "self-intersecting wire"},
                                                    {IMeshData_Failure, "failure"},
                                                    {IMeshData_UnorientedWire, "unoriented wire"},
                                                    {IMeshData_TooFewPoints, "too few points"}};
  for (const auto& [flag, name] : kNames)
    if (flags & flag) status += (status.empty() ? "" : ", ") + std::string(name);
  return status;
}

// How far the surface leaves the triangle's plane, at the middle and the mid-sides in parameters.
double distance_of_surface(const BRepAdaptor_Surface& surface, const std::array<Vec3, 3>& p, const std::array<gp_Pnt2d, 3>& uv) {
  const Vec3 cross = glm::cross(p[1] - p[0], p[2] - p[0]);
  const double area = glm::length(cross);
  if (!(area > 0)) return 0;  // no ray hits it
  constexpr double kWeights[4][3] = {{1. / 3, 1. / 3, 1. / 3}, {.5, .5, 0}, {0, .5, .5}, {.5, 0, .5}};
  double most = 0;
  for (const auto& w : kWeights) {
    const gp_XY at = uv[0].XY() * w[0] + uv[1].XY() * w[1] + uv[2].XY() * w[2];
    most = std::max(most, std::abs(glm::dot(vec(surface.Value(at.X(), at.Y())) - p[0], cross / area)));
  }
  return most;
}

// Each triangle takes over the largest deviation around its corners: a ray may meet the surface beside the triangle it hits.
void spread_deviations(std::span<MeshTriangle> triangles, std::uint32_t first_point, std::size_t points) {
  std::vector<float> at(points, 0);
  for (const MeshTriangle& t : triangles)
    for (const std::uint32_t c : t.corners) at[c - first_point] = std::max(at[c - first_point], t.deviation);
  for (MeshTriangle& t : triangles)
    for (const std::uint32_t c : t.corners) t.deviation = std::max(t.deviation, at[c - first_point]);
}

// Adds the triangles of a face; false if it has none.
bool add_face(const TopoDS_Face& face, int number, OcctMesh& mesh) {
  TopLoc_Location place;
  const Handle(Poly_Triangulation)& triangulation = BRep_Tool::Triangulation(face, place);
  if (triangulation.IsNull() || triangulation->NbTriangles() == 0) return false;
  const auto first_point = std::uint32_t(mesh.points.size());
  const std::size_t first_triangle = mesh.triangles.size();
  for (int i = 1; i <= triangulation->NbNodes(); ++i) {
    mesh.points.push_back(vec(triangulation->Node(i).Transformed(place.Transformation())));
    mesh.box.include(mesh.points.back());
  }
  const BRepAdaptor_Surface surface(face, Standard_False);
  for (int i = 1; i <= triangulation->NbTriangles(); ++i) {
    std::array<int, 3> nodes;
    triangulation->Triangle(i).Get(nodes[0], nodes[1], nodes[2]);
    MeshTriangle triangle{{}, number, 0};
    std::array<Vec3, 3> p;
    std::array<gp_Pnt2d, 3> uv;
    for (std::size_t c = 0; c < 3; ++c) {
      triangle.corners[c] = first_point + std::uint32_t(nodes[c] - 1);
      p[c] = mesh.points[triangle.corners[c]];
      if (triangulation->HasUVNodes()) uv[c] = triangulation->UVNode(nodes[c]);
    }
    if (triangulation->HasUVNodes()) triangle.deviation = float(distance_of_surface(surface, p, uv));
    mesh.triangles.push_back(triangle);
  }
  spread_deviations(std::span(mesh.triangles).subspan(first_triangle), first_point, mesh.points.size() - first_point);
  return true;
}

OcctMesh mesh_file(const std::string& path, const MeshFineness& fineness) {
  const TopoDS_Shape shape = read_occt_shape(path);
  Bnd_Box box;
  BRepBndLib::Add(shape, box, Standard_False);
  if (box.IsVoid()) throw OcctFailure("Open CASCADE finds nothing that has a size");

  OcctMesh mesh;
  mesh.deflection = fineness.deflection * std::sqrt(box.SquareExtent());
  OSD_Chronometer clock(Standard_True);
  clock.Start();
  mesh.status = mesh_shape(shape, mesh.deflection, fineness.angle);
  clock.Stop();
  mesh.seconds = clock.UserTimeCPU() + clock.SystemTimeCPU();
  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(shape, TopAbs_FACE, faces);
  mesh.faces = faces.Extent();
  for (int i = 1; i <= faces.Extent(); ++i)
    if (!add_face(TopoDS::Face(faces(i)), i - 1, mesh)) mesh.unmeshed.push_back(i - 1);
  if (mesh.triangles.empty()) throw OcctFailure("Open CASCADE makes no triangle of the file");
  return mesh;
}

}  // namespace

OcctMesh mesh_with_occt(const std::string& path, const MeshFineness& fineness) {
  Message::DefaultMessenger()->ChangePrinters().Clear();  // its chatter
  try {
    return mesh_file(path, fineness);
  } catch (const Standard_Failure& failure) {
    throw OcctFailure(std::string("Open CASCADE fails: ") + failure.DynamicType()->Name() + " " + failure.GetMessageString());
  }
}

bool valid_for_occt(const std::string& path) {
  Message::DefaultMessenger()->ChangePrinters().Clear();
  try {
    return BRepCheck_Analyzer(read_occt_shape(path)).IsValid();
  } catch (const Standard_Failure&) {
    return false;
  }
}

}  // namespace iso::test
