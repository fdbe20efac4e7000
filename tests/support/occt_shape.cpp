#include "tests/support/occt_shape.h"

#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <IGESControl_Reader.hxx>
#include <Interface_Static.hxx>
#include <STEPControl_Reader.hxx>
#include <cctype>
#include <filesystem>

namespace iso::test {
namespace {

template <class Reader>
TopoDS_Shape transferred(Reader& reader, const std::string& path) {
  Interface_Static::SetCVal("xstep.cascade.unit", "MM");
  if (reader.ReadFile(path.c_str()) != IFSelect_RetDone) throw OcctFailure("Open CASCADE cannot read the file");
  reader.TransferRoots();
  return reader.OneShape();
}

}  // namespace

TopoDS_Shape read_occt_shape(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  for (char& c : ending) c = char(std::tolower(static_cast<unsigned char>(c)));
  TopoDS_Shape shape;
  if (ending == ".step" || ending == ".stp") {
    STEPControl_Reader reader;
    shape = transferred(reader, path);
  } else if (ending == ".iges" || ending == ".igs") {
    IGESControl_Reader reader;
    shape = transferred(reader, path);
  } else {
    BRepTools::Read(shape, path.c_str(), BRep_Builder());
  }
  if (shape.IsNull()) throw OcctFailure("Open CASCADE finds no shape in the file");
  BRepTools::Clean(shape);  // a BREP file may bring an old mesh along
  return shape;
}

}  // namespace iso::test
