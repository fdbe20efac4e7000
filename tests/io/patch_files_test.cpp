// Files of n-sided patches (.ipatch, .gbp, .lop, .mp) and control meshes read as patches.
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <random>
#include <set>

#include "patches/io/patch_set.h"
#include "patches/io/read_model.h"
#include "patches/io/side_curves.h"
#include "patches/io/write_patches.h"
#include "tests/support/paths.h"

namespace iso::test {
namespace {

std::string text_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  EXPECT_TRUE(in) << path;
  return {std::istreambuf_iterator<char>(in), {}};
}

using Parse = PatchSet (*)(const std::string&, std::string_view);
PatchSet set_of(const std::string& name, Parse parse) { return parse(name, text_of(data("patches/" + name))); }

std::string told(const PatchSet& set) {
  std::string text;
  for (const Problem& p : set.problems) text += p.entity + ": " + p.what + " x" + std::to_string(p.count) + "\n";
  return text;
}

Point3 chart_point(const NSidedPatch& patch, const Vec2& st) {
  std::vector<double> W(patch.points.size());
  weights_at(patch.basis, st, W);
  Point3 p(0.0);
  for (std::size_t m = 0; m < W.size(); ++m) p += W[m] * patch.points[m];
  return p;
}

// The boundary curve of a side at a parameter.
Point3 side_point(const NSidedPatch& patch, int side, double t) {
  std::vector<Vec3> work;
  for (const int m : points_of_side(patch.basis, side)) work.push_back(patch.points[static_cast<std::size_t>(m)]);
  for (std::size_t left = work.size() - 1; left > 0; --left)
    for (std::size_t i = 0; i < left; ++i) work[i] = (1 - t) * work[i] + t * work[i + 1];
  return work[0];
}

// ---- the files of the collections ------------------------------------------------------------------------------------------

TEST(PatchFiles, TheGeneralisedBezierPatchHasItsPointsInTheirPlaces) {
  const PatchSet set = set_of("salvi-cagd-86.gbp", parse_gbp);
  EXPECT_EQ(told(set), "");
  ASSERT_EQ(set.patches.size(), 1u);
  const NSidedPatch& patch = set.patches[0].patch;
  EXPECT_EQ(patch.basis, (PatchBasis{PatchKind::generalised_bezier, 5, 5, SideParameters::wachspress}));
  ASSERT_EQ(patch.points.size(), 46u);
  EXPECT_EQ(patch.points[0], Vec3(-65.3028, 27.3761, 57.5802));
  // The first side of the file runs from its first corner to its second.
  EXPECT_EQ(side_point(patch, 1, 0), Vec3(-101.021, 22.1996, -19.5271));
  EXPECT_EQ(side_point(patch, 1, 1), Vec3(-122.21, 57.9959, -0.700653));
  EXPECT_EQ(side_point(patch, 0, 0), Vec3(0, -5.87233, 29.6632));
  EXPECT_EQ(chart_point(patch, {0, 0}), Vec3(-101.021, 22.1996, -19.5271));
}

// The ribbons of one file are the first two rows of the other.
TEST(PatchFiles, RibbonsGiveTheFirstTwoRowsOfTheGeneralisedBezierPatch) {
  const PatchSet ribbons = set_of("salvi-cagd-86.mp", parse_mp), whole = set_of("salvi-cagd-86.gbp", parse_gbp);
  EXPECT_EQ(told(ribbons), "");
  const NSidedPatch &a = ribbons.patches.at(0).patch, &b = whole.patches.at(0).patch;
  ASSERT_EQ(a.basis, b.basis);
  EXPECT_EQ(ribbons.patches[0].approximation_error, 0);
  double largest = 0;
  for (std::size_t m = 1; m < 1 + 25 + 15; ++m) largest = std::max(largest, glm::length(a.points[m] - b.points[m]));
  EXPECT_LE(largest, 2e-4) << "the digits of the file";
  EXPECT_LE(glm::length(chart_point(a, {1, 1}) - chart_point(b, {1, 1})), 0.02 * 187) << "what is free goes on much the same";
}

TEST(PatchFiles, TheMidpointOfRibbonsIsTheCentre) {
  const PatchSet set = set_of("salvi-sphere-6.mp", parse_mp);
  ASSERT_EQ(set.patches.size(), 1u);
  const NSidedPatch& patch = set.patches[0].patch;
  EXPECT_EQ(patch.basis.sides, 6);
  EXPECT_EQ(patch.basis.degree, 3);
  EXPECT_LE(glm::length(chart_point(patch, {1, 1}) - Vec3(0, 0, 1)), 8 * kEps);
  for (int side = 0; side < 6; ++side)
    for (double t = 0; t <= 1; t += 0.125) EXPECT_NEAR(glm::length(side_point(patch, side, t)), 1, 0.01) << side << " " << t;
}

NurbsCurve<Vec3> lop_curve(std::istream& in) {
  NurbsCurve<Vec3> curve;
  std::size_t knots = 0, points = 0;
  in >> curve.degree >> knots;
  curve.knots.resize(knots);
  for (double& k : curve.knots) in >> k;
  in >> points;
  for (std::size_t i = 0; i < points; ++i) {
    Vec3 p;
    in >> p.x >> p.y >> p.z;
    curve.poles.push_back(homogeneous(p, 1));
  }
  EXPECT_TRUE(in);
  return curve;
}

// The curves of the file, read another way, are never farther from the patch's sides than is told, and some nearly as far.
TEST(PatchFiles, LoopsOfCurvesKeepTheirStatedDistance) {
  int files = 0, exact = 0, fitted = 0;
  for (const char* name : {"salvi-cagd-86.lop", "salvi-pocket-3-sided.lop", "salvi-pocket-4-sided.lop", "salvi-pocket-6-sided.lop"}) {
    const PatchSet set = set_of(name, parse_lop);
    const PatchEntry& entry = set.patches.at(0);
    ++files;
    std::ifstream in(data(std::string("patches/") + name));
    int n = 0;
    in >> n;
    ASSERT_EQ(n, entry.patch.basis.sides);
    double worst = 0;
    for (int side = 1; side <= n; ++side) {
      const NurbsCurve<Vec3> curve = lop_curve(in);
      double largest = 0;
      for (int i = 0; i <= 1000; ++i)
        largest = std::max(largest, glm::length(jet(Curve3(curve), i / 1000.0).C - side_point(entry.patch, side, i / 1000.0)));
      if (pieces_of(curve) == 1) {
        EXPECT_LE(largest, 1e-12 * 200) << name << " side " << side;
      }
      (pieces_of(curve) == 1 ? exact : fitted)++;
      worst = std::max(worst, largest);
    }
    EXPECT_LE(worst, entry.approximation_error) << name;
    EXPECT_GE(worst, 0.5 * entry.approximation_error) << name << ": the bound is loose";
    EXPECT_LE(entry.approximation_error, 1e-3 * 200) << name;
    const std::string problems = told(set);
    EXPECT_NE(problems.find("fitted in degree"), std::string::npos) << problems;
    EXPECT_NE(problems.find("boundary curves only"), std::string::npos) << problems;
    std::cout << name << ": degree " << entry.patch.basis.degree << ", " << worst << " away, " << entry.approximation_error << " stated\n";
  }
  EXPECT_EQ(files, 4);
  EXPECT_EQ(exact + fitted, 18);
  EXPECT_EQ(exact, 4);
}

std::string lop_square() {
  return "4\n1 4 0 0 1 1  2 0 0 0 1 0 0\n1 4 0 0 1 1 2 1 0 0 1 1 0\n1 4 0 0 1 1 2 1 1 0 0 1 0\n1 4 0 0 1 1 2 0 1 0 0 0 0\n";
}

TEST(PatchFiles, ALoopOfLinesIsThePlane) {
  const PatchSet set = parse_lop("square.lop", lop_square());
  const NSidedPatch& patch = set.patches.at(0).patch;
  EXPECT_EQ(patch.basis.degree, 3);
  EXPECT_EQ(set.patches[0].approximation_error, 0);
  for (double s = 0; s <= 1; s += 0.25)
    for (double t = 0; t <= 1; t += 0.25) EXPECT_LE(glm::length(chart_point(patch, {s, t}) - Vec3(0.5 * s, 0.5 * t, 0)), 8 * kEps);
}

TEST(PatchFiles, WhatFollowsThePatchIsReported) {
  const PatchSet set = parse_lop("square.lop", lop_square() + "7 8\n9\n");
  ASSERT_EQ(set.problems.size(), 2u);
  EXPECT_EQ(set.problems[1].kind, Problem::Kind::dropped);
  EXPECT_EQ(set.problems[1].entity, "line 6");
  EXPECT_EQ(set.problems[1].count, 3);
}

// Cubic ribbons that turn differently at a corner need its two inner points.
TEST(PatchFiles, RibbonsThatTurnDifferentlyBecomeGeneralisedGregory) {
  const std::string good = text_of(data("patches/salvi-sphere-6.mp"));
  EXPECT_EQ(parse_mp("a.mp", good).patches.at(0).patch.basis.kind, PatchKind::generalised_bezier);
  std::string turned = good;
  const std::string second = "0.20246140999999993 -0.09298665146275698 1.14276912325018332";
  ASSERT_NE(turned.find(second), std::string::npos);
  turned.replace(turned.find(second), second.size(), "0.2 -0.09 1.3");
  const PatchSet set = parse_mp("a.mp", turned);
  EXPECT_EQ(set.patches.at(0).patch.basis.kind, PatchKind::generalised_gregory);
  EXPECT_EQ(told(set), "");
  EXPECT_LE(glm::length(chart_point(set.patches[0].patch, {1, 1}) - Vec3(0, 0, 1)), 8 * kEps);
}

// ---- .ipatch: back bit for bit ---------------------------------------------------------------------------------------------

bool same_bits(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }
void expect_same(const PatchEntry& a, const PatchEntry& b) {
  EXPECT_EQ(a.patch.basis, b.patch.basis);
  ASSERT_EQ(a.patch.points.size(), b.patch.points.size());
  for (std::size_t i = 0; i < a.patch.points.size(); ++i)
    for (int c = 0; c < 3; ++c) EXPECT_TRUE(same_bits(a.patch.points[i][c], b.patch.points[i][c])) << a.patch.points[i][c];
  ASSERT_EQ(a.patch.weights.size(), b.patch.weights.size());
  for (std::size_t i = 0; i < a.patch.weights.size(); ++i) EXPECT_TRUE(same_bits(a.patch.weights[i], b.patch.weights[i]));
  EXPECT_EQ(a.corners, b.corners);
  EXPECT_EQ(a.name, b.name);
  ASSERT_EQ(a.colour.has_value(), b.colour.has_value());
  EXPECT_TRUE(!a.colour || (a.colour->r == b.colour->r && a.colour->g == b.colour->g && a.colour->b == b.colour->b));
  EXPECT_TRUE(same_bits(a.approximation_error, b.approximation_error));
}

// Doubles of every size that a file may hold, and those that are hard to write.
double awkward(std::mt19937_64& random) {
  static constexpr double kHard[] = {0.0,   -0.0, 5e-324,  -2.2250738585072014e-308, 5e14,
                                     -5e14, 0.1,  1.0 / 3, 9007199254740991.0 / 16,  123456789012345.0};
  if (random() % 8 == 0) return kHard[random() % std::size(kHard)];
  const double mantissa = std::ldexp(double(random() >> 11), -53) * 2 - 1;
  return std::ldexp(mantissa, static_cast<int>(random() % 100) - 51);
}

PatchEntry random_entry(PatchKind kind, std::mt19937_64& random) {
  PatchEntry entry;
  PatchBasis& basis = entry.patch.basis;
  basis = {kind, 3, 3, SideParameters::wachspress};
  do {
    basis.sides = 3 + static_cast<int>(random() % 14);
    basis.degree = 1 + static_cast<int>(random() % 15);
    basis.parameters = static_cast<SideParameters>(random() % 3);
  } while (!problem_of(basis).empty());
  for (int i = 0; i < point_count(basis); ++i) entry.patch.points.emplace_back(awkward(random), awkward(random), awkward(random));
  if (kind == PatchKind::bezier_triangle && random() % 2)
    for (int i = 0; i < point_count(basis); ++i) entry.patch.weights.push_back(std::ldexp(1 + double(random() >> 12), -52));
  if (random() % 2)
    for (int k = 0; k < basis.sides; ++k) entry.corners.push_back(static_cast<long long>(random() >> 17));
  if (random() % 2) entry.colour = Colour{float(random() % 1000) / 999, 0.1f, 0};
  if (random() % 2) entry.name = "piece \"" + std::to_string(random() % 100) + "\"\t\xc3\xa9";
  if (random() % 2) entry.approximation_error = std::abs(awkward(random));
  return entry;
}

TEST(PatchFiles, EveryKindComesBackBitForBit) {
  std::mt19937_64 random(5);
  std::set<PatchKind> kinds;
  for (int round = 0; round < 40; ++round) {
    PatchSet set;
    if (round % 2) set.name = "set " + std::to_string(round);
    for (int k = 0; k < kPatchKinds; ++k) {
      set.patches.push_back(random_entry(static_cast<PatchKind>(k), random));
      kinds.insert(set.patches.back().patch.basis.kind);
    }
    const std::string text = ipatch_text(set);
    const PatchSet again = parse_ipatch("again.ipatch", text);
    EXPECT_EQ(again.name, set.name);
    ASSERT_EQ(again.patches.size(), set.patches.size());
    for (std::size_t i = 0; i < set.patches.size(); ++i) expect_same(set.patches[i], again.patches[i]);
    EXPECT_EQ(ipatch_text(again), text);
  }
  EXPECT_EQ(kinds.size(), static_cast<std::size_t>(kPatchKinds));
}

TEST(PatchFiles, SchemaAndReaderKnowTheSameMembers) {
  const auto schema = nlohmann::json::parse(text_of(ISOPHOTE_SOURCE_DIR "/patches/io/ipatch.schema.json"));
  int objects = 0;
  for (const auto& [name, definition] : schema["$defs"].items()) {
    if (!definition.contains("properties")) continue;
    ++objects;
    EXPECT_EQ(definition["additionalProperties"], false) << name;
    std::set<std::string> in_schema;
    for (const auto& property : definition["properties"].items()) in_schema.insert(property.key());
    EXPECT_EQ(in_schema, std::set<std::string>(ipatch_members(name).begin(), ipatch_members(name).end())) << name;
  }
  EXPECT_EQ(objects, 2);
  const auto& patch = schema["$defs"]["patch"]["properties"];
  for (int k = 0; k < kPatchKinds; ++k) EXPECT_EQ(patch["kind"]["enum"][static_cast<std::size_t>(k)], word_of(static_cast<PatchKind>(k)));
  EXPECT_EQ(patch["kind"]["enum"].size(), static_cast<std::size_t>(kPatchKinds));
  EXPECT_EQ(patch["parameters"]["enum"].size(), kSideParameterWords.size());
  EXPECT_EQ(patch["sides"]["maximum"], kMostSides);
  EXPECT_EQ(schema["$defs"]["set"]["properties"]["format"]["const"], kPatchFileFormat);
}

// ---- damage ----------------------------------------------------------------------------------------------------------------

struct Damage {
  std::string text;
  const char *place, *says;
};
void expect_refused(Parse parse, const char* name, const std::vector<Damage>& all) {
  int refused = 0;
  for (const Damage& d : all) {
    try {
      parse(name, d.text);
      ADD_FAILURE() << "accepted:\n" << d.text;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind, Exit::bad_input);
      EXPECT_EQ(error.file, name);
      EXPECT_EQ(error.place, d.place) << d.text << "\n" << error.text();
      EXPECT_NE(error.message.find(d.says), std::string::npos) << d.text << "\n" << error.text();
      ++refused;
    }
  }
  EXPECT_EQ(refused, static_cast<int>(all.size()));
}

TEST(PatchFiles, DamagedNumbersAreRefusedWithTheirLine) {
  expect_refused(parse_gbp, "bad.gbp",
                 {{"", "1", "found the end of the file, expected the number of sides"},
                  {"2 5\n", "1", "found \"2\", expected the number of sides, 3 to 16"},
                  {"17 5\n", "1", "expected the number of sides"},
                  {"5 2\n", "1", "found degree 2, expected 3 to"},
                  {"5 5\n0 0 0\n1 1\n", "3", "point 2 of 46: found the end of the file, expected a coordinate"},
                  {"5 5\n0 0 0\n1 x 1\n", "3", "found \"x\", expected a coordinate (point 2 of 46)"},
                  {"5 5\n0 0 nan\n", "2", "found \"nan\", expected a coordinate (point 1 of 46), finite"}});
  const std::string square = lop_square();
  expect_refused(parse_lop, "bad.lop",
                 {{"4\n0 4 0 0 1 1 2 0 0 0 1 0 0\n", "2", "side 1 of 4: found \"0\", expected a degree"},
                  {"4\n1 3 0 0 1\n", "2", "side 1 of 4: found \"3\", expected the number of knots, at least 4"},
                  {"4\n1 4 0 0 1 1 3 0 0 0\n", "2", "expected the number of points, 2 for these knots"},
                  {"4\n1 4 0 1 0 1 2 0 0 0\n1 0 0\n", "3", "side 1 of 4: "},
                  {"4\n1 4 0 0 1 1e300 2 0 0 0\n", "2", "expected a knot (side 1 of 4: knot 4 of 4), finite"},
                  {square.substr(0, 40), "3", "side 2 of 4: found the end of the file, expected the number of points"},
                  {"3" + square.substr(1), "2", "found a curve that begins at (0, 0, 0), expected the end of the one before, (0, 1, 0)"}});
  const std::string sphere = text_of(data("patches/salvi-sphere-6.mp"));
  expect_refused(parse_mp, "bad.mp",
                 {{"3\n3 3\n", "2", "side 1 of 3: outer curve: found \"3\", expected the number of points, at least 4"},
                  {"3\n1 2\n0 0 1 1\n0 0 0\n1 0 0\n", "5", "side 1 of 3: inner curve: found the end of the file, expected a degree"},
                  {sphere.substr(0, sphere.rfind('1')), "74", "midpoint: found the end of the file, expected a coordinate"}});
}

std::string ipatch(const std::string& members) {
  return "{\n\"format\": \"isophote-patches\", \"version\": 1,\n\"patches\": [{" + members + "}]}";
}
constexpr const char* kTriangle = "\"kind\": \"bezier-triangle\", \"sides\": 3, \"degree\": 1, \"points\": [[0,0,0],[1,0,0],[0,1,0]]";

TEST(PatchFiles, DamagedIpatchFilesAreRefusedWithTheirPlace) {
  const std::string triangle = kTriangle;
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = triangle;
    text.replace(text.find(from), from.size(), to);
    return ipatch(text);
  };
  EXPECT_EQ(parse_ipatch("good.ipatch", ipatch(triangle)).patches.size(), 1u);
  expect_refused(parse_ipatch, "bad.ipatch",
                 {{"", "1:1", "expected JSON"},
                  {"{\n  \"format\": ,", "2:13", "expected JSON"},
                  {"{\"format\": \"isophote-patches\", \"format\": 1}", "JSON", "found the member \"format\" twice"},
                  {"[]", "JSON", "found array, expected an object"},
                  {"{\"format\": \"gltf\"}", "format", "found \"gltf\", expected isophote-patches"},
                  {"{\"format\": \"isophote-patches\", \"version\": 2}", "version", "found 2, expected 1 to 1"},
                  {"{\"format\": \"isophote-patches\", \"version\": 1, \"patches\": []}", "patches", "found no patches"},
                  {ipatch("\"sort\": 1"), "patches[0]", "found the unknown member \"sort\", expected kind, sides"},
                  {with("bezier-triangle", "bezier-square"), "patches[0].kind", "found \"bezier-square\", expected bezier-triangle, "},
                  {with("\"sides\": 3", "\"sides\": 17"), "patches[0].sides", "found 17, expected 3 to 16"},
                  {with("\"sides\": 3", "\"sides\": 4"), "patches[0]", "4 sides, expected 3"},
                  {with("\"degree\": 1", "\"degree\": 2"), "patches[0].points", "found 3 points, expected 6"},
                  {with("\"degree\": 1", "\"degree\": 99"), "patches[0]", "degree 99"},
                  {with("[1,0,0]", "[1,0]"), "patches[0].points[1]", "found 2 entries, expected x, y and z"},
                  {with("[1,0,0]", "[1,0,null]"), "patches[0].points[1][2]", "found null, expected a number"},
                  {with("[1,0,0]", "[1,0,1e16]"), "patches[0].points[1][2]", "at most 1e15"},
                  {with("[1,0,0]", "[1,0,1e999]"), "JSON", "expected JSON"},
                  {ipatch(triangle + ", \"weights\": [1, 1]"), "patches[0].weights", "found 2 weights, expected 3"},
                  {ipatch(triangle + ", \"weights\": [1, 1, 0]"), "patches[0]", "weight"},
                  {ipatch(triangle + ", \"parameters\": \"chord\""), "patches[0].parameters", "found \"chord\", expected wachspress"},
                  {ipatch(triangle + ", \"corners\": [1, 2]"), "patches[0].corners", "found 2 corners, expected 3"},
                  {ipatch(triangle + ", \"corners\": [1, 2, -3]"), "patches[0].corners[2]", "expected a whole number"},
                  {ipatch(triangle + ", \"colour\": [1, 1, -1]"), "patches[0].colour", "negative"},
                  {ipatch(triangle + ", \"name\": 7"), "patches[0].name", "found number, expected text"},
                  {ipatch(triangle + ", \"approximation_error\": -1"), "patches[0].approximation_error", "negative"}});
}

// Any file cut anywhere, or with bytes changed, is refused with a place, or read.
TEST(PatchFiles, CutAndChangedFilesAreRefusedOrRead) {
  struct File {
    std::string name, text;
    Parse parse;
  };
  std::vector<File> files{{"a.ipatch", ipatch_text(set_of("salvi-cagd-86.gbp", parse_gbp)), parse_ipatch}};
  for (const auto& [name, parse] : std::initializer_list<std::pair<const char*, Parse>>{{"salvi-cagd-86.gbp", parse_gbp},
                                                                                        {"salvi-cagd-86.lop", parse_lop},
                                                                                        {"salvi-pocket-3-sided.lop", parse_lop},
                                                                                        {"salvi-sphere-6.mp", parse_mp}})
    files.push_back({name, text_of(data(std::string("patches/") + name)), parse});
  std::mt19937_64 random(7);
  int refused = 0, read = 0;
  for (const File& file : files)
    for (int round = 0; round < 150; ++round) {
      std::string text = file.text;
      std::size_t at = random() % text.size();
      if (round % 3 == 0) text.resize(at);
      if (round % 3 == 1)
        for (int k = 0; k < 3; ++k) text[random() % text.size()] = " 0159-.ex\n[],"[random() % 13];
      if (round % 3 == 2) {
        while (text[at] < '0' || text[at] > '9') at = random() % text.size();
        text[at] = "0123456789"[random() % 10];
      }
      try {
        const PatchSet set = file.parse(file.name, text);
        EXPECT_EQ(problem_of(set.patches.at(0).patch), "");
        ++read;
      } catch (const Error& error) {
        EXPECT_FALSE(error.place.empty()) << error.text();
        EXPECT_EQ(error.file, file.name);
        ++refused;
      }
    }
  EXPECT_EQ(refused + read, 750);
  EXPECT_GE(refused, 300);
  EXPECT_GE(read, 50);
}

}  // namespace
}  // namespace iso::test
