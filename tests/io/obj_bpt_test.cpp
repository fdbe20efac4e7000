// The readers of Newell patch sets (.bpt) and of OBJ free-form surfaces.
#include <gtest/gtest.h>

#include <fstream>
#include <iostream>
#include <random>
#include <stdexcept>

#include "patches/io/read_model.h"
#include "tests/support/paths.h"

namespace iso::test {
namespace {

const char* const kBptFiles[] = {"patches/teapot.bpt", "patches/teacup.bpt", "patches/teaspoon.bpt"};
const char* const kObjFiles[] = {"patches/teapot-bezier.obj", "patches/teacup-bezier.obj", "patches/teaspoon-bezier.obj",
                                 "patches/sphere-rational-bspline.obj", "patches/wave-trimmed-hole.obj"};

std::string text_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  EXPECT_TRUE(in) << path;
  return {std::istreambuf_iterator<char>(in), {}};
}

Result<Model> read(const std::string& path) { return path.ends_with(".bpt") ? read_bpt(path) : read_obj(path); }

// Reads a text as a file of the given name.
Result<Model> read_text_as(const std::string& name, const std::string& text) {
  const TemporaryDir dir;
  const std::string path = dir.path() / name;
  std::ofstream(path, std::ios::binary) << text;
  return read(path);
}

Model model_of(const std::string& name, const std::string& text) {
  auto model = read_text_as(name, text);
  if (!model) throw std::runtime_error(model.error().text());
  return *model;
}
Model model_of_file(const std::string& name) {
  auto model = read(data(name));
  if (!model) throw std::runtime_error(model.error().text());
  return *model;
}

// What every model must keep, whatever the file held.
void expect_sound(const Model& model, const std::string& what) {
  ASSERT_EQ(model.parts.size(), 1u) << what;
  ASSERT_EQ(model.instances.size(), 1u) << what;
  EXPECT_FALSE(model.parts[0].faces.empty()) << what;
  for (const Face& face : model.parts[0].faces) {
    EXPECT_EQ(problem_of(face.surface), "") << what;
    EXPECT_FALSE(face.domain.empty()) << what;
    EXPECT_FALSE(face.name.empty()) << what;
    EXPECT_TRUE(finite(point(face.surface, face.domain.lo)) && finite(point(face.surface, face.domain.middle()))) << what;
  }
}

double largest_gap(const TrimLoop& loop) {
  double gap = 0;
  for (std::size_t i = 0; i < loop.curves.size(); ++i) {
    const TrimCurve &a = loop.curves[i], &b = loop.curves[(i + 1) % loop.curves.size()];
    gap = std::max(gap, glm::length(jet(a.curve, a.t1).C - jet(b.curve, b.t0).C));
  }
  return gap;
}

const NurbsSurface& nurbs(const Face& face) { return std::get<NurbsSurface>(face.surface); }

// ---- .bpt --------------------------------------------------------------------------------------------------------------

TEST(Bpt, TheTeapotHas32BicubicPatchesWithTheirKnownCorners) {
  const Model model = model_of_file("patches/teapot.bpt");
  EXPECT_EQ(model.format, "BPT");
  EXPECT_TRUE(model.problems.empty());
  ASSERT_EQ(model.parts[0].faces.size(), 32u);
  for (const Face& face : model.parts[0].faces) {
    EXPECT_EQ(nurbs(face).degree_u, 3);
    EXPECT_EQ(nurbs(face).degree_v, 3);
    EXPECT_TRUE(face.loops.empty());
    EXPECT_EQ(face.domain.lo, Vec2(0.0));
    EXPECT_EQ(face.domain.hi, Vec2(1.0));
  }

  // The first patch of the rim: its corners are the first, 4th, 13th and 16th point.
  const AnySurface& rim = model.parts[0].faces[0].surface;
  EXPECT_EQ(point(rim, {0, 0}), Point3(1.4, 0, 2.4));
  EXPECT_EQ(point(rim, {1, 0}), Point3(0, -1.4, 2.4));
  EXPECT_EQ(point(rim, {0, 1}), Point3(1.5, 0, 2.4));
  EXPECT_EQ(point(rim, {1, 1}), Point3(0, -1.5, 2.4));
}

TEST(Bpt, TheTeaSetHasItsPatchCounts) {
  EXPECT_EQ(model_of_file("patches/teacup.bpt").parts[0].faces.size(), 26u);
  EXPECT_EQ(model_of_file("patches/teaspoon.bpt").parts[0].faces.size(), 16u);
}

TEST(Bpt, PointsRunAlongUFirst) {
  // Degrees 1 and 2: z = v^2 over the unit square, comments and empty lines between.
  const Model model = model_of("a.bpt", "# one patch\n1\n\n1 2\n0 0 0\n1 0 0\n0 .5 0 # here\n1 0.5 0\n0 1 1\n1 +1 1e0\n");
  ASSERT_EQ(model.parts[0].faces.size(), 1u);
  const AnySurface& s = model.parts[0].faces[0].surface;
  EXPECT_EQ(point(s, {1, 0}), Point3(1, 0, 0));
  EXPECT_EQ(point(s, {0, 1}), Point3(0, 1, 1));
  EXPECT_LT(glm::length(point(s, {0.25, 0.5}) - Point3(0.25, 0.5, 0.25)), 1e-15);
}

TEST(Bpt, LinesAfterTheLastPatchAreReported) {
  const Model model = model_of("a.bpt", "1\n1 1\n0 0 0\n1 0 0\n0 1 0\n1 1 0\nmore\nand more\n");
  ASSERT_EQ(model.problems.size(), 1u);
  EXPECT_EQ(model.problems[0].kind, Problem::Kind::dropped);
  EXPECT_EQ(model.problems[0].entity, "line 7");
  EXPECT_EQ(model.problems[0].count, 2);
}

// ---- two files, one shape ----------------------------------------------------------------------------------------------

TEST(ObjAndBpt, TheTeaSetIsTheSameInBothFormats) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  int compared = 0;
  for (int f = 0; f < 3; ++f) {
    const Model a = model_of_file(kBptFiles[f]), b = model_of_file(kObjFiles[f]);
    ASSERT_EQ(a.parts[0].faces.size(), b.parts[0].faces.size());
    for (std::size_t i = 0; i < a.parts[0].faces.size(); ++i)
      for (int k = 0; k < 20; ++k, ++compared) {
        const UV uv{unit(random), unit(random)};
        ASSERT_EQ(point(a.parts[0].faces[i].surface, uv), point(b.parts[0].faces[i].surface, uv)) << kBptFiles[f] << " patch " << i + 1;
      }
  }
  EXPECT_EQ(compared, (32 + 26 + 16) * 20);
}

// ---- OBJ ---------------------------------------------------------------------------------------------------------------

TEST(Obj, TheRationalSphereHasRadiusOneEverywhere) {
  const Model model = model_of_file("patches/sphere-rational-bspline.obj");
  ASSERT_EQ(model.parts[0].faces.size(), 1u);
  const Face& face = model.parts[0].faces[0];
  EXPECT_EQ(nurbs(face).count_u, 9);
  EXPECT_EQ(nurbs(face).count_v, 5);
  EXPECT_TRUE(nurbs(face).rational());
  EXPECT_TRUE(nurbs(face).closed_u);
  EXPECT_FALSE(nurbs(face).closed_v);
  EXPECT_EQ(face.domain.hi, Vec2(4, 2));

  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> u(0, 4), v(0, 2);
  double worst = 0;
  for (int k = 0; k < 100000; ++k) worst = std::max(worst, std::abs(glm::length(point(face.surface, {u(random), v(random)})) - 1));
  EXPECT_LE(worst, 8 * kEps);
  EXPECT_EQ(point(face.surface, {1, 1}).z, 0);
  EXPECT_LT(glm::length(point(face.surface, {1, 1}) - Point3(0, 1, 0)), 4 * kEps);
}

TEST(Obj, TheWaveKeepsItsSquareBorderAndItsRoundHole) {
  const Model model = model_of_file("patches/wave-trimmed-hole.obj");
  ASSERT_EQ(model.parts[0].faces.size(), 1u);
  const Face& face = model.parts[0].faces[0];
  EXPECT_LT(glm::length(face.domain.lo - Vec2(0.2)), 1e-8) << "the border's box";
  EXPECT_LT(glm::length(face.domain.hi - Vec2(2.8)), 1e-8);
  ASSERT_EQ(face.loops.size(), 2u);

  // The border runs through the corners of [0.2, 2.8]^2, counter-clockwise.
  ASSERT_EQ(face.loops[0].curves.size(), 1u);
  const TrimCurve& border = face.loops[0].curves[0];
  const UV corners[] = {{0.2, 0.2}, {2.8, 0.2}, {2.8, 2.8}, {0.2, 2.8}, {0.2, 0.2}};
  for (int i = 0; i < 5; ++i) EXPECT_LT(glm::length(jet(border.curve, double(i)).C - corners[i]), 4 * kEps);

  // Every point of the hole is 0.6 away from (1.5, 1.5).
  ASSERT_EQ(face.loops[1].curves.size(), 1u);
  const TrimCurve& hole = face.loops[1].curves[0];
  for (int i = 0; i <= 1000; ++i)
    EXPECT_NEAR(glm::length(jet(hole.curve, hole.t0 + (hole.t1 - hole.t0) * i / 1000).C - UV(1.5, 1.5)), 0.6, 1e-14);
  EXPECT_TRUE(model.problems.empty());
}

// Two cubic Bezier pieces in u with a breakpoint at 2 have to be the pieces themselves, over [0, 2] and [2, 3].
TEST(Obj, ChainedBezierPatchesRunOverTheBreakpointsOfParm) {
  const double xs[2][4] = {{0, 1, 2, 4}, {4, 5, 5.5, 7}};
  std::string text;
  for (int row = 0; row < 2; ++row)
    for (const double x : {0.0, 1.0, 2.0, 4.0, 5.0, 5.5, 7.0})
      text += "v " + std::to_string(x) + " " + std::to_string(row) + " " + std::to_string(x * x) + "\n";
  text += "cstype bezier\ndeg 3 1\nsurf 0 3 0 1 1 2 3 4 5 6 7 8 9 10 11 12 13 14\nparm u 0 2 3\nparm v 0 1\nend\n";
  const Model model = model_of("chain.obj", text);
  ASSERT_EQ(model.parts[0].faces.size(), 1u);
  const AnySurface& s = model.parts[0].faces[0].surface;
  for (int piece = 0; piece < 2; ++piece)
    for (double t = 0; t <= 1; t += 0.125) {
      const double* p = xs[piece];
      const double x =
          (1 - t) * (1 - t) * (1 - t) * p[0] + 3 * t * (1 - t) * (1 - t) * p[1] + 3 * t * t * (1 - t) * p[2] + t * t * t * p[3];
      EXPECT_NEAR(point(s, {piece == 0 ? 2 * t : 2 + t, 0.5}).x, x, 1e-14);
    }
}

// A plane unit square over [0, 1]^2 in the manner of the file under test.
std::string square(const std::string& before_end = "") {
  return "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\ncstype bezier\ndeg 1 1\nsurf 0 1 0 1 1 2 3 4\nparm u 0 1\nparm v 0 1\n" + before_end +
         "end\n";
}
// Line pieces as trim curves; `square` may follow.
std::string segments(const std::vector<std::pair<UV, UV>>& segments) {
  std::string s = "cstype bezier\ndeg 1\n";
  for (const auto& [a, b] : segments)
    s += "vp " + std::to_string(a.x) + " " + std::to_string(a.y) + "\nvp " + std::to_string(b.x) + " " + std::to_string(b.y) +
         "\ncurv2 -2 -1\nparm u 0 1\nend\n";
  return s;
}

TEST(Obj, NamesNegativeNumbersContinuationsAndTextureNumbersAreUnderstood) {
  const Model model =
      model_of("names.obj",
               "o body\ng left  side\nv 0 0 0\nv 1 0 0 0.5\nv 0 1 0 1 0 0\nv 1 1 2\nvt 0 0\nvn 0 0 1\ncstype bspline\r\ndeg 1 1\n"
               "surf 0 1 \\\n 0 1 -4/1 -3/1/1 3//1 \\\n4\nparm u 0 0 1 1\nparm v 0 0 1 1 # done\nend\n");
  ASSERT_EQ(model.parts[0].faces.size(), 1u);
  const Face& face = model.parts[0].faces[0];
  EXPECT_EQ(face.name, "body/left side");
  EXPECT_FALSE(nurbs(face).rational()) << "weights count only under rat";
  EXPECT_EQ(point(face.surface, {1, 0}), Point3(1, 0, 0));
  EXPECT_EQ(point(face.surface, {1, 1}), Point3(1, 1, 2));
  EXPECT_TRUE(model.problems.empty());
}

TEST(Obj, TheRangeOfSurfIsTheDomain) {
  std::string text = square();
  text.replace(text.find("surf 0 1 0 1"), 12, "surf 0.25 0.5 0 0.75");
  const Face face = model_of("part.obj", text).parts[0].faces.at(0);
  EXPECT_EQ(face.domain.lo, Vec2(0.25, 0));
  EXPECT_EQ(face.domain.hi, Vec2(0.5, 0.75));
}

TEST(Obj, SeveralTriplesMakeOneLoopAlsoBackwards) {
  const std::string curves = segments({{{0.1, 0.1}, {0.9, 0.1}}, {{0.5, 0.9}, {0.9, 0.1}}, {{0.5, 0.9}, {0.1, 0.1}}});
  const Model model = model_of("triples.obj", curves + square("trim 0 1 1 1 0 2 0 1 -1\n"));
  ASSERT_EQ(model.parts[0].faces.at(0).loops.size(), 1u);
  const TrimLoop& loop = model.parts[0].faces[0].loops[0];
  ASSERT_EQ(loop.curves.size(), 3u);
  EXPECT_EQ(loop.curves[1].t0, 1);
  EXPECT_EQ(loop.curves[1].t1, 0);
  EXPECT_EQ(largest_gap(loop), 0);
  EXPECT_TRUE(model.problems.empty());
}

TEST(Obj, AnOpenLoopIsBridgedAndReported) {
  const std::string curves = segments({{{0.1, 0.1}, {0.9, 0.1}}, {{0.9, 0.2}, {0.5, 0.9}}});
  const Model model = model_of("open.obj", curves + square("trim 0 1 1 0 1 2\n"));
  ASSERT_EQ(model.parts[0].faces.at(0).loops.size(), 1u);
  EXPECT_EQ(model.parts[0].faces[0].loops[0].curves.size(), 4u);
  EXPECT_LT(largest_gap(model.parts[0].faces[0].loops[0]), 1e-15);
  ASSERT_EQ(model.problems.size(), 1u);
  EXPECT_EQ(model.problems[0].kind, Problem::Kind::repaired);
  EXPECT_EQ(model.problems[0].entity, "line 22");
}

TEST(Obj, AHoleAloneHasTheDomainAroundIt) {
  const std::string curves = segments({{{0.1, 0.1}, {0.9, 0.1}}, {{0.9, 0.1}, {0.5, 0.9}}, {{0.5, 0.9}, {0.1, 0.1}}});
  const Model model = model_of("hole.obj", curves + square("hole 0 1 1 0 1 2 0 1 3\n"));
  ASSERT_EQ(model.parts[0].faces.at(0).loops.size(), 2u);
  const TrimLoop& border = model.parts[0].faces[0].loops[0];
  ASSERT_EQ(border.curves.size(), 4u);
  EXPECT_EQ(largest_gap(border), 0);
  EXPECT_EQ(jet(border.curves[2].curve, 0).C, UV(1, 1));
}

TEST(Obj, WhatCannotBeUsedIsCountedAndNamed) {
  const Model model = model_of("mixed.obj", square() +
                                                "f 1 2 3\nf 1 2 4\nusemtl red\nwobble 1\ncurv 0 1 1 2\nparm u 0 1\nend\ncstype "
                                                "cardinal\ndeg 3 3\nsurf 0 1 0 1 1\nparm u 0 1\nend\n");
  EXPECT_EQ(model.parts[0].faces.size(), 1u);
  std::string told;
  int dropped = 0;
  for (const Problem& p : model.problems) {
    told += p.entity + ": " + p.what + " x" + std::to_string(p.count) + "\n";
    if (p.kind == Problem::Kind::dropped) dropped += p.count;
  }
  EXPECT_EQ(dropped, 5) << told;
  for (const char* part : {"line 11: polygons (f); --patches makes patches of them x2", "line 13: materials",
                           "line 14: statements that are not known, from \"wobble\"", "line 15: space curves",
                           "surf of line 20: cstype cardinal is not supported x1"})
    EXPECT_NE(told.find(part), std::string::npos) << part << " in\n" << told;
}

TEST(Obj, APolygonFileIsRefusedAsControlMesh) {
  const auto model = read_text_as("cube.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  ASSERT_FALSE(model);
  EXPECT_EQ(model.error().kind, Exit::bad_input);
  EXPECT_EQ(model.error().place, "4");
  EXPECT_NE(model.error().message.find("--patches gregory makes patches of a control mesh's polygons"), std::string::npos)
      << model.error().text();
}

// ---- damage ------------------------------------------------------------------------------------------------------------

struct Damage {
  const char* text;
  const char* place;
  const char* says;
};
void expect_refused(const std::string& name, const std::vector<Damage>& all) {
  int refused = 0;
  for (const Damage& d : all) {
    const auto model = read_text_as(name, d.text);
    ASSERT_FALSE(model) << d.text;
    EXPECT_EQ(model.error().kind, Exit::bad_input);
    EXPECT_EQ(model.error().place, d.place) << d.text << "\n" << model.error().text();
    EXPECT_NE(model.error().message.find(d.says), std::string::npos) << d.text << "\n" << model.error().text();
    EXPECT_NE(model.error().text().find(name + ":" + d.place + ": "), std::string::npos) << model.error().text();
    ++refused;
  }
  EXPECT_EQ(refused, int(all.size()));
}

TEST(Bpt, DamageIsRefusedWithItsLine) {
  expect_refused("bad.bpt", {
                                {"", "1", "found the end of the file, expected the number of patches"},
                                {"0\n", "1", "found \"0\", expected the number of patches"},
                                {"-3\n", "1", "expected the number of patches"},
                                {"99999999999999999999\n", "1", "expected the number of patches"},
                                {"1 2\n", "1", "2 words"},
                                {"\x7f"
                                 "ELF\n",
                                 "1", "found \"?ELF\""},
                                {"1\n3\n", "2", "expected two degrees"},
                                {"1\n0 3\n", "2", "expected two degrees from 1 to"},
                                {"1\n3 4000000\n", "2", "expected two degrees from 1 to"},
                                {"1\n1 1\n0 0 0\n1 0\n", "4", "point 2 of 4: found 2 words"},
                                {"1\n1 1\n0 0 0\n1 0 zero\n0 1 0\n1 1 0\n", "4", "found \"zero\", expected a coordinate"},
                                {"1\n1 1\n0 0 0\n1 0 nan\n0 1 0\n1 1 0\n", "4", "found \"nan\""},
                                {"1\n1 1\n0 0 0\n1 0 inf\n0 1 0\n1 1 0\n", "4", "finite"},
                                {"1\n1 1\n0 0 0\n1 0 1e300\n0 1 0\n1 1 0\n", "4", "at most 1e15"},
                                {"1\n1 1\n0 0 0\n1 0 1e999\n0 1 0\n1 1 0\n", "4", "at most 1e15"},
                                {"1\n1 1\n0 0 0\n1 0 1,5\n0 1 0\n1 1 0\n", "4", "found \"1,5\""},
                                {"2\n1 1\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n", "6", "patch 2 of 2: found the end of the file"},
                                {"1\n1 1\n0 0 0\n1 0 0\n0 1 0\n", "5", "point 4 of 4: found the end of the file"},
                            });
}

TEST(Obj, DamageIsRefusedWithItsLine) {
  const std::string four = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\n";
  const std::string head = four + "cstype bezier\ndeg 1 1\n";
  const std::string rational = four + "v 0 0 0 0\ncstype rat bspline\ndeg 1 1\n";
  const std::string curve = segments({{{0.1, 0.1}, {0.9, 0.1}}});  // six lines
  const std::string parm = "parm u 0 1\nparm v 0 1\n";
  const std::vector<std::array<std::string, 3>> all{
      {"", "1", "expected at least one free-form surface"},
      {"v 0 0\n", "1", "v has 2 numbers"},
      {"v 0 0 x\n", "1", "found \"x\", expected a coordinate"},
      {"v 0 0 nan\n", "1", "finite"},
      {"v 0 0 1e200\n", "1", "at most 1e15"},
      {"vp\n", "1", "vp has 0 numbers"},
      {"cstype nurbs\n", "1", "found cstype \"nurbs\""},
      {"cstype\n", "1", "cstype of 0 words"},
      {"deg 0 3\n", "1", "found the degree \"0\""},
      {"deg 3 1000000\n", "1", "expected 1 to"},
      {four + "surf 0 1 0 1 1 2 3 4\n", "5", "before any cstype"},
      {four + "cstype bezier\nsurf 0 1 0 1 1 2 3 4\n" + parm + "end\n", "6", "two degrees"},
      {head + "surf 0 1 0 1\n", "7", "surf has 4 words"},
      {head + "surf 1 0 0 1 1 2 3 4\n", "7", "expected s0 < s1"},
      {head + "surf 0 1 0 1 1 2 3 0\n", "7", "found \"0\", expected the number of a vertex"},
      {head + "surf 0 1 0 1 1 2 3 -5\n", "7", "there are 4 up to here"},
      {head + "surf 0 1 0 1 1 2 3 99\n" + parm + "end\n", "7", "vertex 99; the file has 4"},
      {head + "surf 0 1 0 1 1 2 3\n" + parm + "end\n", "7", "surf has 3 control points, its degrees and parameters need 2 x 2 = 4"},
      {head + "surf 0 1 0 1 1 2 3 4\nparm u 0 1\nend\n", "7", "parm v has 0 values"},
      {head + "surf 0 1 0 1 1 2 3 4\nparm u 1 0\nparm v 0 1\nend\n", "7", "value 2 of 2 is not larger"},
      {head + "surf 0 2 0 1 1 2 3 4\n" + parm + "end\n", "7", "not inside the range of the knots"},
      {head + "surf 0 1 0 1 1 2 3 4\nparm w 0 1\n", "8", "expected parm u or parm v"},
      {head + "surf 0 1 0 1 1 2 3 4\nparm u 0 1\nparm u 0 1\n", "9", "second parm u"},
      {head + "surf 0 1 0 1 1 2 3 4\n" + parm, "9", "expected `end` for the surf of line 7"},
      {head + "surf 0 1 0 1 1 2 3 4\n" + parm + "surf 0 1 0 1 1 2 3 4\n", "10", "expected `end` for the surf of line 7"},
      {head + parm, "7", "parm outside of surf"},
      {head + "end\n", "7", "end outside of surf"},
      {rational + "surf 0 1 0 1 1 2 3 5\nparm u 0 0 1 1\nparm v 0 0 1 1\nend\n", "8", "vertex 5 has the weight 0.0"},
      {rational + "surf 0 1 0 1 1 2 3 4\nparm u 0 0 1 0.5\nparm v 0 0 1 1\nend\n", "8", "value 4 of 4 is smaller"},
      {rational + "surf 0 1 0 1 1 2 3 4\nparm u 0 1\nparm v 0 0 1 1\nend\n", "8", "expected at least 4"},
      {rational + "surf 0 1 0 1 1 2 3 4\nparm u 1 1 1 1\nparm v 0 0 1 1\nend\n", "8", "range"},
      {square("trim 0 1\n"), "10", "found 2 numbers, expected triples"},
      {square("trim 0 1 1\n"), "10", "found trim curve 1; the file has 0"},
      {curve + square("trim 0 2 1\n"), "17", "found the curve parameter 2.0"},
      {segments({{{2, 2}, {3, 3}}}) + square("trim 0 1 1\n"), "14", "outside of its range"},
      {curve + square("trim 0.5 0.5 1\n"), "17", "same parameter"},
      {"cstype bezier\ndeg 1\ncurv2 1 2\nparm u 0 1\nend\n" + square("trim 0 1 1\n"), "3", "parameter vertex 1; the file has 0"},
      {"vp 0 0\nvp 1 1\ncstype bezier\ndeg 2\ncurv2 1 2\nparm u 0 1\nend\n" + square("trim 0 1 1\n"), "5", "curv2 has 2 points"},
      {"f 1 2 3\n", "1", "1 polygons and no free-form surface"},
      {four + "cstype taylor\ndeg 1 1\nsurf 0 1 0 1 1\nparm u 0 1\nend\n", "7", "none of the 1 surfaces can be used: cstype taylor"},
  };
  std::vector<Damage> damage;
  for (const auto& d : all) damage.push_back({d[0].c_str(), d[1].c_str(), d[2].c_str()});
  expect_refused("bad.obj", damage);
}

TEST(ObjAndBpt, MissingFilesAndFoldersAreReadErrors) {
  const TemporaryDir dir;
  for (const std::string path : {dir.path() / "none.obj", dir.path() / "none.bpt", dir.path()}) {
    const auto model = read(path);
    ASSERT_FALSE(model) << path;
    EXPECT_EQ(model.error().kind, Exit::read_write) << model.error().text();
    EXPECT_EQ(model.error().file, path);
  }
}

// A file cut anywhere is refused with a line, or (cut after the last element) read.
TEST(ObjAndBpt, TruncatedFilesAreRefusedOrSound) {
  const TemporaryDir dir;
  int refused = 0, read_whole = 0;
  std::vector<const char*> files(std::begin(kBptFiles), std::end(kBptFiles));
  files.insert(files.end(), std::begin(kObjFiles), std::end(kObjFiles));
  for (const char* name : files) {
    const std::string text = text_of(data(name)), path = dir.path() / std::filesystem::path(name).filename();
    for (std::size_t length = 0; length < text.size(); length += 50) {
      std::ofstream(path, std::ios::binary) << text.substr(0, length);
      const auto model = read(path);
      if (model) {
        expect_sound(*model, path);
        ++read_whole;
        // A .bpt cut before its last number is never whole; an OBJ is, between two elements.
        EXPECT_TRUE(path.ends_with(".obj") || length + 3 > text.size()) << path << " cut at " << length;
      } else {
        EXPECT_FALSE(model.error().place.empty()) << model.error().text();
        ++refused;
      }
    }
  }
  std::cout << refused << " refused, " << read_whole << " read\n";
  EXPECT_GT(refused, 800);
}

// Random bytes in the place of others: refused with a line, or read into something sound.
TEST(ObjAndBpt, OverwrittenFilesAreRefusedOrSound) {
  const TemporaryDir dir;
  std::mt19937_64 random(3);
  int refused = 0, read_whole = 0;
  for (const char* name : {"patches/teaspoon.bpt", "patches/sphere-rational-bspline.obj", "patches/wave-trimmed-hole.obj"}) {
    const std::string text = text_of(data(name)), path = dir.path() / std::filesystem::path(name).filename();
    const std::string letters = "0123456789.-+e \n\\#/uvabcdefgnirt";
    for (int k = 0; k < 400; ++k) {
      std::string damaged = text;
      for (int n = int(random() % 4); n >= 0; --n)
        damaged[random() % damaged.size()] = random() % 8 ? letters[random() % letters.size()] : char(random() % 256);
      std::ofstream(path, std::ios::binary) << damaged;
      const auto model = read(path);
      if (model)
        expect_sound(*model, damaged);
      else
        EXPECT_FALSE(model.error().place.empty()) << model.error().text();
      ++(model ? read_whole : refused);
    }
  }
  std::cout << refused << " refused, " << read_whole << " read\n";
  EXPECT_EQ(refused + read_whole, 1200);
  EXPECT_GT(refused, 100);
  EXPECT_GT(read_whole, 100);
}

}  // namespace
}  // namespace iso::test
