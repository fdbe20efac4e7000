#include "tests/support/occt_scale.h"

#include <BRepBuilderAPI_Transform.hxx>
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <STEPControl_Reader.hxx>
#include <STEPControl_Writer.hxx>
#include <Standard_Failure.hxx>
#include <TopoDS_Shape.hxx>
#include <gp_Trsf.hxx>

#include "patches/io/occt_session.h"

namespace iso::test {

namespace {

std::string read_shape(const std::string& path, TopoDS_Shape& shape) {
  if (path.ends_with(".brep")) return BRepTools::Read(shape, path.c_str(), BRep_Builder()) ? "" : "cannot read " + path;
  STEPControl_Reader reader;
  if (reader.ReadFile(path.c_str()) != IFSelect_RetDone || reader.TransferRoots() < 1) return "cannot read " + path;
  shape = reader.OneShape();
  return {};
}

}  // namespace

std::string write_scaled_step(const std::string& from, double factor, const std::string& to) {
  const occt::Session session;
  try {
    TopoDS_Shape shape;
    if (const std::string wrong = read_shape(from, shape); !wrong.empty()) return wrong;
    gp_Trsf scale;
    scale.SetScaleFactor(factor);
    const TopoDS_Shape scaled = BRepBuilderAPI_Transform(shape, scale, true).Shape();
    STEPControl_Writer writer;
    if (writer.Transfer(scaled, STEPControl_AsIs) != IFSelect_RetDone) return "cannot convert " + from;
    return writer.Write(to.c_str()) == IFSelect_RetDone ? "" : "cannot write " + to;
  } catch (const Standard_Failure& failure) {
    return from + ": " + failure.GetMessageString();
  }
}

}  // namespace iso::test
