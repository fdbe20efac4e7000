// STEP, IGES and BREP through Open CASCADE. STEP and IGES come as XCAF documents (assemblies, names, colours), BREP as a bare shape.
#include <fmt/format.h>

#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <IGESCAFControl_Reader.hxx>
#include <IGESData_GlobalSection.hxx>
#include <IGESData_IGESModel.hxx>
#include <Interface_Static.hxx>
#include <Quantity_Color.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <Standard_ErrorHandler.hxx>
#include <Standard_Failure.hxx>
#include <TColStd_SequenceOfAsciiString.hxx>
#include <TDF_ChildIterator.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopoDS_Compound.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <cctype>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <functional>

#include "patches/io/occt_checks.h"
#include "patches/io/occt_cycles.h"
#include "patches/io/occt_session.h"
#include "patches/io/occt_shape.h"
#include "patches/io/read_model.h"

namespace iso {
namespace {

using occt::FaceStyles;
using occt::ModelBuilder;

std::string name_of(const TDF_Label& label) {
  Handle(TDataStd_Name) attribute;
  if (!label.FindAttribute(TDataStd_Name::GetID(), attribute)) return {};
  const TCollection_ExtendedString& name = attribute->Get();
  std::string utf8(static_cast<size_t>(name.LengthOfCString()) + 1, '\0');
  Standard_PCharacter data = utf8.data();
  utf8.resize(static_cast<size_t>(std::max(0, name.ToUTF8CString(data))));
  return utf8;
}

// Open CASCADE's colours are linear, Rec. 709 primaries. The colour of the surface goes before the general one.
std::optional<Colour> colour_of(const TDF_Label& label) {
  Quantity_Color c;
  if (!XCAFDoc_DocumentTool::ColorTool(label)->GetColor(label, XCAFDoc_ColorSurf, c) &&
      !XCAFDoc_DocumentTool::ColorTool(label)->GetColor(label, XCAFDoc_ColorGen, c))
    return std::nullopt;
  return Colour(float(c.Red()), float(c.Green()), float(c.Blue()));
}

// The styles of a shape and its parts; the smaller the part, the later it is written, so a face's own colour wins.
void add_styles(const TDF_Label& label, FaceStyles& styles) {
  const TopoDS_Shape whole = XCAFDoc_ShapeTool::GetShape(label);
  if (const auto c = colour_of(label)) styles.colour(whole, *c);
  TDF_LabelSequence parts;
  XCAFDoc_ShapeTool::GetSubShapes(label, parts);
  for (const TopAbs_ShapeEnum type : {TopAbs_COMPOUND, TopAbs_COMPSOLID, TopAbs_SOLID, TopAbs_SHELL, TopAbs_FACE})
    for (const TDF_Label& part : parts) {
      const TopoDS_Shape shape = XCAFDoc_ShapeTool::GetShape(part);
      if (shape.IsNull() || shape.ShapeType() != type) continue;
      if (const auto c = colour_of(part)) styles.colour(shape, *c);
      if (const std::string name = name_of(part); !name.empty() && type == TopAbs_FACE) styles.name(shape, name);
    }
}

// Walks an assembly. A component's own name and colour go before those it inherits from the assemblies above it.
void add_label(const TDF_Label& label, const TopLoc_Location& place, const std::string& name, std::optional<Colour> colour,
               ModelBuilder& builder) {
  TDF_Label referred;
  if (XCAFDoc_ShapeTool::IsReference(label) && XCAFDoc_ShapeTool::GetReferredShape(label, referred)) {
    if (const auto own = colour_of(label)) colour = own;
    add_label(referred, place * XCAFDoc_ShapeTool::GetLocation(label), name_of(label), colour, builder);
    return;
  }
  TDF_LabelSequence components;
  if (XCAFDoc_ShapeTool::GetComponents(label, components) && !components.IsEmpty()) {
    if (!colour) colour = colour_of(label);
    for (const TDF_Label& component : components) add_label(component, place, name, colour, builder);
    return;
  }
  FaceStyles styles;
  add_styles(label, styles);
  builder.add(XCAFDoc_ShapeTool::GetShape(label), place, name_of(label), name, colour, styles);
}

TDF_LabelSequence free_shapes(const Handle(TDocStd_Document) & document) {
  TDF_LabelSequence labels;
  XCAFDoc_DocumentTool::ShapeTool(document->Main())->GetFreeShapes(labels);
  return labels;
}

// IGES has no assemblies: all its roots are one part, so that loose faces stay together.
void add_as_one(const TDF_LabelSequence& labels, const std::string& name, ModelBuilder& builder) {
  TopoDS_Compound all;
  BRep_Builder().MakeCompound(all);
  FaceStyles styles;
  for (const TDF_Label& label : labels) {
    const TopoDS_Shape shape = XCAFDoc_ShapeTool::GetShape(label);
    if (shape.IsNull()) continue;
    BRep_Builder().Add(all, shape);
    add_styles(label, styles);
    if (const std::string own = name_of(label); !own.empty() && shape.ShapeType() == TopAbs_FACE) styles.name(shape, own);
  }
  builder.add(all, TopLoc_Location(), name, name, std::nullopt, styles);
}

std::string stem_of(const std::string& path) {
  const size_t slash = path.find_last_of('/');
  const std::string file = slash == std::string::npos ? path : path.substr(slash + 1);
  return file.substr(0, file.find_last_of('.'));
}

// Runs a reader with Open CASCADE's exceptions and signals caught and its chatter off.
Result<Model> guarded(const std::string& path, const char* format, const std::function<Result<Model>()>& read) {
  const occt::Session session;
  try {
    OCC_CATCH_SIGNALS
    return read();
  } catch (const Standard_Failure& failure) {
    return bad_input(
        path, "",
        fmt::format("damaged {} file: Open CASCADE failed with {} {}", format, failure.DynamicType()->Name(), failure.GetMessageString()));
  } catch (const std::exception& failure) {
    return bad_input(path, "", fmt::format("damaged {} file: reading it failed with {}", format, failure.what()));
  }
}

Result<Model> read_step_document(const std::string& path) {
  STEPCAFControl_Reader reader;
  reader.SetColorMode(Standard_True);
  reader.SetNameMode(Standard_True);
  Interface_Static::SetCVal("xstep.cascade.unit", "MM");
  if (reader.ReadFile(path.c_str()) != IFSelect_RetDone) return bad_input(path, "", "damaged STEP file: its data section cannot be parsed");
  if (const auto unreadable = occt::unreadable_geometry(reader.Reader().WS()))
    return bad_input(path, unreadable->entity, "damaged STEP file: " + unreadable->message);
  ModelBuilder builder(path, "STEP");
  TColStd_SequenceOfAsciiString lengths, angles, solid_angles;
  reader.ChangeReader().FileUnits(lengths, angles, solid_angles);
  if (!lengths.IsEmpty()) builder.model.file_unit = lengths.First().ToCString();
  builder.model.unit = "mm";
  Handle(TDocStd_Document) document = new TDocStd_Document("BinXCAF");
  if (!reader.Transfer(document)) return bad_input(path, "", "STEP file without shapes: expected at least one product with a shape");
  occt::report_checks(reader.Reader().WS(), builder.model);
  for (const TDF_Label& label : free_shapes(document)) add_label(label, TopLoc_Location(), name_of(label), std::nullopt, builder);
  return builder.take();
}

Result<Model> read_iges_document(const std::string& path) {
  IGESCAFControl_Reader reader;
  reader.SetColorMode(Standard_True);
  reader.SetNameMode(Standard_True);
  Interface_Static::SetCVal("xstep.cascade.unit", "MM");
  if (reader.ReadFile(path.c_str()) != IFSelect_RetDone) return bad_input(path, "", "damaged IGES file: its sections cannot be parsed");
  if (const auto group = occt::group_within_itself(reader.IGESModel()))
    return bad_input(path, fmt::format("D{}", *group), "damaged IGES file: the group is part of itself");
  ModelBuilder builder(path, "IGES");
  if (const auto iges = reader.IGESModel(); !iges.IsNull() && !iges->GlobalSection().UnitName().IsNull())
    builder.model.file_unit = iges->GlobalSection().UnitName()->ToCString();
  builder.model.unit = "mm";
  Handle(TDocStd_Document) document = new TDocStd_Document("BinXCAF");
  if (!reader.Transfer(document)) return bad_input(path, "", "IGES file without shapes: expected curves or surfaces");
  occt::report_checks(reader.WS(), builder.model);
  add_as_one(free_shapes(document), stem_of(path), builder);
  return builder.take();
}

Result<Model> read_brep_shape(const std::string& path) {
  // The library counts on every number being there and loops for as long as a damaged count says: the stream must throw.
  std::ifstream in(path, std::ios::binary);
  in.exceptions(std::ios::failbit | std::ios::badbit);
  TopoDS_Shape shape;
  try {
    BRepTools::Read(shape, in, BRep_Builder());
  } catch (const std::ios_base::failure&) {
    return bad_input(path, "", "damaged BREP file: a number is missing, or is none");
  }
  if (shape.IsNull()) return bad_input(path, "", "damaged BREP file: no shape can be read from it");
  ModelBuilder builder(path, "BREP");
  builder.add(shape, TopLoc_Location(), stem_of(path), "", std::nullopt, {});
  return builder.take();
}

// The last `count` bytes of a file.
std::string tail_of(const std::string& path, std::streamoff count) {
  std::ifstream in(path, std::ios::binary | std::ios::ate);
  const std::streamoff size = in.tellg();
  in.seekg(std::max<std::streamoff>(0, size - count));
  std::string tail(static_cast<size_t>(std::min(size, count)), '\0');
  in.read(tail.data(), static_cast<std::streamsize>(tail.size()));
  return tail;
}

// Takes the last line that is not blank off the text.
std::string take_last_line(std::string& text) {
  const auto blank = [](char c) { return std::isspace(static_cast<unsigned char>(c)) || c == '\0'; };
  while (!text.empty() && blank(text.back())) text.pop_back();
  const size_t start = text.find_last_of("\r\n") + 1;
  std::string line = text.substr(start);
  text.resize(start);
  return line;
}

// The last line of a BREP file names its root: a sign, the number of the shape, the number of its location; what DRAW wrote is
// followed by a zero.
bool ends_with_root(std::string text) {
  std::string line = take_last_line(text);
  if (line == "0") line = take_last_line(text);
  char sign = 0;
  int shape = -1, location = -1;
  return std::sscanf(line.c_str(), "%c%d %d", &sign, &shape, &location) == 3 && std::strchr("+-ie", sign) != nullptr &&
         line.find('*') == line.npos;
}

}  // namespace

Result<Model> read_step(const std::string& path) {
  if (tail_of(path, 1 << 16).find("END-ISO-10303-21") == std::string::npos)
    return bad_input(path, "", "truncated STEP file: expected END-ISO-10303-21 at its end");
  return guarded(path, "STEP", [&] { return read_step_document(path); });
}

Result<Model> read_iges(const std::string& path) {
  std::string tail = tail_of(path, 1 << 12);
  const std::string last = take_last_line(tail);
  if (last.size() < 73 || last[72] != 'T')
    return bad_input(path, "", "truncated IGES file: expected a terminate line (T in column 73) at its end");
  return guarded(path, "IGES", [&] { return read_iges_document(path); });
}

Result<Model> read_brep(const std::string& path) {
  if (!ends_with_root(tail_of(path, 1 << 12)))
    return bad_input(path, "", "truncated BREP file: expected the number of the root shape (as in \"+1 0\") at its end");
  return guarded(path, "BREP", [&] { return read_brep_shape(path); });
}

}  // namespace iso
