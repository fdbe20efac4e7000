#include "tests/bench/occt_plate.h"

#include <BRepAlgoAPI_Cut.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeRevol.hxx>
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <GC_MakeArcOfCircle.hxx>
#include <Standard_Failure.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Face.hxx>
#include <cmath>
#include <stdexcept>

namespace iso::bench {
namespace {

enum class Head { flat, cone, dome };

constexpr int kAcross = 5;
constexpr double kPitch = 2, kThickness = 1.5, kDepth = 1, kHole = 0.6;
constexpr double kPin = 0.5, kFoot = 0.05, kNeck = 0.8, kTip = 0.3, kHeadHeight = 0.3;  // kFoot: above the hole's ground

// Half the section of a pin through its axis, turned once around; z = 0 at its foot.
TopoDS_Shape pin(const gp_Pnt& foot, Head head) {
  const auto at = [&](double r, double z) { return gp_Pnt(foot.X() + r, foot.Y(), foot.Z() + z); };
  const double top = head == Head::flat ? kNeck : kNeck + kHeadHeight;
  const double tip = head == Head::cone ? kTip : head == Head::flat ? kPin : 0;
  BRepBuilderAPI_MakeWire outline;
  const auto line = [&](const gp_Pnt& a, const gp_Pnt& b) { outline.Add(BRepBuilderAPI_MakeEdge(a, b)); };
  line(at(0, 0), at(kPin, 0));
  line(at(kPin, 0), at(kPin, kNeck));
  if (head == Head::cone) line(at(kPin, kNeck), at(kTip, top));
  if (head == Head::dome) {
    // The circle about the axis through the neck and the top.
    const double radius = (kPin * kPin + kHeadHeight * kHeadHeight) / (2 * kHeadHeight), middle = top - radius;
    const double half = 0.5 * std::atan2(kPin, kNeck - middle);
    outline.Add(BRepBuilderAPI_MakeEdge(
        GC_MakeArcOfCircle(at(kPin, kNeck), at(radius * std::sin(half), middle + radius * std::cos(half)), at(0, top)).Value()));
  } else {
    line(at(tip, top), at(0, top));
  }
  line(at(0, top), at(0, 0));
  return BRepPrimAPI_MakeRevol(BRepBuilderAPI_MakeFace(outline.Wire()).Face(), gp_Ax1(foot, gp::DZ())).Shape();
}

TopoDS_Shape plate_with_pins() {
  TopoDS_Compound all;
  BRep_Builder builder;
  builder.MakeCompound(all);
  TopTools_ListOfShape plate, drills;
  plate.Append(BRepPrimAPI_MakeBox(gp_Pnt(0, 0, 0), kAcross * kPitch, kAcross * kPitch, kThickness).Shape());
  for (int i = 0; i < kAcross; ++i)
    for (int j = 0; j < kAcross; ++j) {
      const gp_Pnt ground((i + 0.5) * kPitch, (j + 0.5) * kPitch, kThickness - kDepth);
      drills.Append(BRepPrimAPI_MakeCylinder(gp_Ax2(ground, gp::DZ()), kHole, 2 * kDepth).Shape());
      constexpr Head kHeads[] = {Head::dome, Head::cone, Head::flat};
      builder.Add(all, pin(ground.Translated(gp_Vec(0, 0, kFoot)), kHeads[(i * kAcross + j) % 3]));
    }
  BRepAlgoAPI_Cut cut;
  cut.SetArguments(plate);
  cut.SetTools(drills);
  cut.Build();
  if (!cut.IsDone()) throw std::runtime_error("Open CASCADE cannot drill the plate");
  builder.Add(all, cut.Shape());
  return all;
}

}  // namespace

void write_plate_with_pins(const std::string& path) {
  try {
    if (!BRepTools::Write(plate_with_pins(), path.c_str())) throw std::runtime_error("cannot write " + path);
  } catch (const Standard_Failure& failure) {
    throw std::runtime_error(std::string("Open CASCADE cannot make the plate: ") + failure.GetMessageString());
  }
}

}  // namespace iso::bench
