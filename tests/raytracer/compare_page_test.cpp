// The page, the JSON and the table of a comparison: well-formed whatever names and numbers a report holds, and of one mind.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>

#include "raytracer/cmd/compare_charts.h"
#include "raytracer/cmd/page_text.h"
#include "tests/support/html_check.h"
#include "tests/support/made_up_report.h"
#include "tests/support/tally.h"

namespace iso::test {
namespace {

using nlohmann::json;

std::vector<CompareReport> all_reports() {
  std::vector<CompareReport> reports{CompareReport{},   made_up_report(0), made_up_report(1),
                                     made_up_report(3), nasty_report(),    made_up_report(2, 1000)};
  // Without pictures; on a plane, where every distance is zero.
  reports.push_back(made_up_report(3));
  for (ReportMesh& mesh : reports.back().meshes) mesh.pictures.clear(), mesh.comparison.all = made_up_face(0, 0, 12);
  reports.back().pictures.clear();
  return reports;
}

// ---- page ---------------------------------------------------------------------------------------------------------------

TEST(ComparePage, IsWellFormedWhateverNamesAndNumbersHold) {
  for (const CompareReport& report : all_reports()) {
    const std::string text = compare_page(report);
    const HtmlPage page = read_html(text);
    for (const std::string& complaint : page.complaints) ADD_FAILURE() << report.model << ": " << complaint;
    EXPECT_EQ(text, valid_utf8(text));
    EXPECT_EQ(page.named("h1").size(), 1u);
    EXPECT_EQ(page.named("script").size(), 1u);
    EXPECT_EQ(page.named("html").at(0)->attributes.at("lang"), "en");
    for (const HtmlElement* img : page.named("img")) EXPECT_FALSE(img->attributes.at("alt").empty());
    EXPECT_EQ(text, compare_page(report));
  }
}

TEST(ComparePage, TheCheckerObjectsToWhatIsWrong) {
  for (const char* wrong : {"<p>", "<p></b>", "<b><p></b></p>", "<p>a < b</p>", "<p>a & b</p>", "<p a=1></p>", "<p a=\"1\" a=\"2\"></p>",
                            "<p id=\"a\"></p><p id=\"a\"></p>", "<p", "</p>", "a > b"})
    EXPECT_FALSE(read_html(wrong).complaints.empty()) << wrong;
  EXPECT_TRUE(read_html("<!DOCTYPE html>\n<p id=\"a\">a &lt; b<br><img alt=\"&amp;\"></p><script>a < b && c</script>").complaints.empty());
}

TEST(ComparePage, AsksForNothingOutsideOfItself) {
  int addresses = 0;
  for (const CompareReport& report : all_reports()) {
    const std::string text = compare_page(report);
    for (const char* outside : {"http://", "https://", "url(", "@import", "<link", "<iframe", "//"})
      EXPECT_TRUE(report.verdict == kNasty || text.find(outside) == std::string::npos) << outside;
    const HtmlPage page = read_html(text);
    for (const HtmlElement& element : page.elements)
      for (const auto& [name, value] : element.attributes) {
        EXPECT_FALSE(name.starts_with("on")) << name;
        EXPECT_TRUE(name != "src" || value.starts_with("data:image/png;base64,")) << value;
        EXPECT_TRUE(name != "href" || std::regex_match(value, std::regex("#[a-z]+|\\./[A-Za-z0-9_.%-]+"))) << value;
        addresses += name == "src" || name == "href";
      }
  }
  EXPECT_GE(addresses, 50);
}

void collect_numbers(const json& value, std::set<std::string>& out) {
  if (value.is_number()) out.insert(value.dump());
  if (value.is_structured())
    for (const json& child : value) collect_numbers(child, out);
}

// The number in front of a shown text, in the unit of its value; NaN: there is none.
double number_shown(std::string text) {
  for (std::size_t i; (i = text.find("\xE2\x80\xAF")) != text.npos;) text.erase(i, 3);
  char* rest = nullptr;
  const double x = std::strtod(text.c_str(), &rest);
  if (rest == text.c_str()) return std::nan("");
  const std::string unit = rest;
  if (unit == " kB") return 1e3 * x;
  if (unit == " MB") return 1e6 * x;
  if (unit == " GB") return 1e9 * x;
  return unit == " %" ? 0.01 * x : x;
}

TEST(ComparePage, EveryNumberItShowsStandsInTheJsonAndIsRoundedFromThere) {
  Tally tally("numbers");
  for (const CompareReport& report : all_reports()) {
    std::set<std::string> numbers;
    collect_numbers(json::parse(compare_json(report)), numbers);
    const HtmlPage page = read_html(compare_page(report));
    for (const HtmlElement* data : page.named("data")) {
      const std::string& value = data->attributes.at("value");
      tally.check(numbers.count(value) == 1, [&] { return "not in the JSON: " + value; });
      const double exact = std::stod(value), shown = number_shown(data->text);
      tally.check(std::abs(shown - exact) <= 5e-3 * std::abs(exact), [&] { return fmt::format("{} is shown as {}", value, data->text); });
    }
  }
  tally.finish_at_least(2000);
}

TEST(ComparePage, TellsTheVerdictEveryFaultAndEveryMesh) {
  CompareReport report = made_up_report(3);
  report.advice = "Take the second.";
  report.failures = {"above 0.1 mm"};
  report.meshes[2].comparison.faults = {{MeshFault::missing_face, 1, "Face 3 is bare.", {}, 0, 3, 0, {}},
                                        {MeshFault::doubled_triangles, 4, "4 triangles are there twice.", {}, -1, -1, 0, {}}};
  report.meshes[1].broken = {"1 crack"};
  report.meshes[0].comparison.unmeasured_faces = 3;
  const std::string page = compare_page(report);
  for (const char* told : {"<h1>1e-3 d keeps its promise.</h1>", "Take the second.", "above 0.1 mm", "fault: missing-face",
                           "Face 3 is bare.", "warning: doubled-triangles", "not kept", "1 crack",
                           "3 faces of the model could not be measured", "theirs.stl", "exact: 0", "a machine", "Slope of error"})
    EXPECT_NE(page.find(told), std::string::npos) << told;
  const HtmlPage read = read_html(page);
  EXPECT_EQ(read.named("svg").size(), 3u);
  EXPECT_EQ(read.named("input").size(), 3u) << "a slider a mesh";
}

TEST(ComparePage, AThousandFacesStayFiftyRowsAMesh) {
  const CompareReport report = made_up_report(2, 1000);
  const HtmlPage page = read_html(compare_page(report));
  std::size_t rows = 0;
  for (const HtmlElement* th : page.named("th")) rows += th->text.ends_with(" top");
  EXPECT_EQ(rows, 100u);
  EXPECT_LT(compare_page(report).size(), 200000u);
}

// ---- text ---------------------------------------------------------------------------------------------------------------

TEST(PageText, FiguresHaveThreeDigits) {
  const std::pair<double, const char*> figures[] = {{0, "0"},
                                                    {1.47e-13, "1.47e-13"},
                                                    {1.2345e-5, "1.23e-5"},
                                                    {0.0498, "0.0498"},
                                                    {0.87654, "0.877"},
                                                    {12.345, "12.3"},
                                                    {999.4, "999"},
                                                    {999.6, "1000"},
                                                    {1234.5, "1230"},
                                                    {-48310,
                                                     "-48\xE2\x80\xAF"
                                                     "300"},
                                                    {1.5e9, "1.5e9"},
                                                    {std::nan(""), "unknown"},
                                                    {kInf, "infinite"}};
  for (const auto& [x, text] : figures) EXPECT_EQ(figure_text(x), text);
  EXPECT_EQ(count_text(1234567),
            "1\xE2\x80\xAF"
            "234\xE2\x80\xAF"
            "567");
  EXPECT_EQ(count_text(1234), "1234");
  EXPECT_EQ(bytes_text(3964211), "3.96 MB");
}

TEST(PageText, BytesBecomeBase64AndNamesValidText) {
  for (const auto& [plain, coded] : {std::pair{"", ""}, {"f", "Zg=="}, {"fo", "Zm8="}, {"foo", "Zm9v"}, {"foobar", "Zm9vYmFy"}})
    EXPECT_EQ(base64(plain), coded);
  EXPECT_EQ(base64("\xFB\xFF\xBE"), "+/++");
  EXPECT_EQ(valid_utf8("a\xFF\x01\xE2\x82z\xE2\x82\xAC"), "a\xEF\xBF\xBD\xEF\xBF\xBD\xEF\xBF\xBDz\xE2\x82\xAC");
  EXPECT_EQ(shortened("\xC3\xBC\xC3\xBC\xC3\xBC\xC3\xBC", 3), "\xC3\xBC\xC3\xBC\xE2\x80\xA6");
  EXPECT_EQ(shortened("abc", 3), "abc");
  EXPECT_EQ(link_to("a b\"/\xC3.exr"), "./a%20b%22%2F%C3.exr");
}

TEST(ComparePage, ChartsStayInTheirBoxForAnyNumbers) {
  for (const double scale : {1e-300, 1e-9, 1.0, 1e200}) {
    Chart chart;
    chart.points = {{"a", 10 * scale, scale, true}, {"b", 1e5 * scale, 0, true}, {"c", kInf, 1, true}, {"d", 1, std::nan(""), false}};
    chart.exact_x = scale;
    chart.guide_text = "guide";
    const std::string svg = chart_svg(chart);
    const HtmlPage page = read_html(svg);
    EXPECT_TRUE(page.complaints.empty());
    EXPECT_EQ(svg.find("nan"), std::string::npos);
    EXPECT_EQ(svg.find("inf"), std::string::npos);
    EXPECT_EQ(page.named("circle").size(), 2u);
    for (const HtmlElement& e : page.elements)
      for (const char* name : {"x", "x1", "x2", "cx", "y", "y1", "y2", "cy"})
        if (const auto at = e.attributes.find(name); at != e.attributes.end()) {
          EXPECT_GE(std::stod(at->second), 0) << svg;
          EXPECT_LE(std::stod(at->second), 460) << svg;
        }
    EXPECT_LT(svg.size(), 20000u);
  }
  EXPECT_EQ(chart_svg({}), "");
}

// ---- JSON ---------------------------------------------------------------------------------------------------------------

// The keys that a section of the description names: what stands in backquotes in the first column of its first table.
std::set<std::string> documented(const std::string& section) {
  std::ifstream file(std::string(ISOPHOTE_SOURCE_DIR) + "/raytracer/cmd/compare_report.md");
  std::set<std::string> keys;
  bool inside = false, table = false;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("## ")) inside = line == "## " + section;
    if (!inside) continue;
    if (table && line.empty()) break;
    table = table || line.starts_with("|");
    if (!table) continue;
    const std::string first = line.substr(1, line.find('|', 1) - 1);
    const std::regex quoted("`([^`]+)`");
    for (std::sregex_iterator i(first.begin(), first.end(), quoted), end; i != end; ++i) keys.insert((*i)[1]);
  }
  return keys;
}

std::set<std::string> keys_of(const json& object) {
  std::set<std::string> keys;
  for (const auto& [key, value] : object.items()) keys.insert(key);
  return keys;
}

TEST(CompareJson, HasTheKeysThatItsDescriptionNames) {
  const json report = json::parse(compare_json(nasty_report())), &mesh = report["meshes"][2];
  EXPECT_EQ(keys_of(report), documented("report.json"));
  EXPECT_EQ(keys_of(mesh), documented("A mesh"));
  EXPECT_EQ(keys_of(mesh["faces"][4]), documented("A face"));
  EXPECT_EQ(keys_of(mesh["faults"][0]), documented("A fault"));
  for (const char* name : {"distance", "to_surface", "topology", "cost", "images"}) EXPECT_EQ(keys_of(mesh[name]), documented(name));
  EXPECT_EQ(keys_of(mesh["to_mesh"]), documented("to_surface"));
  EXPECT_EQ(keys_of(report["direct"]), documented("cost"));
  EXPECT_EQ(keys_of(report["pictures"][0]), documented("A picture"));
  EXPECT_EQ(keys_of(report["legends"][0]), documented("A legend"));
  EXPECT_GE(documented("A mesh").size(), 20u);
}

TEST(CompareJson, KeepsNumbersWholeAndWhatIsNotFiniteNull) {
  const json good = json::parse(compare_json(made_up_report(3)));
  EXPECT_EQ(good["camera"]["seed"], 18446744073709551615ull);
  EXPECT_EQ(good["meshes"][0]["distance"]["max"], 0.87654);
  EXPECT_NEAR(good["meshes"][0]["distance"]["pixels"].get<double>(), 0.87654 / 0.0925, 1e-12);
  EXPECT_EQ(good["meshes"][2]["tolerance"], nullptr);
  EXPECT_EQ(good["meshes"].size(), 3u);
  EXPECT_EQ(good["meshes"][1]["faces"].size(), 12u);
  const json bad = json::parse(compare_json(nasty_report()));
  EXPECT_EQ(bad["diagonal"], nullptr);
  EXPECT_EQ(bad["meshes"][0]["distance"]["max"], nullptr);
  EXPECT_EQ(bad["meshes"][0]["faces"][3]["covered_share"], nullptr);
  EXPECT_EQ(bad["meshes"][0]["images"]["psnr"], nullptr);
  EXPECT_EQ(json::parse(compare_json({}))["meshes"].size(), 0u);
  // A line a face.
  const std::string text = compare_json(made_up_report(1, 1000)), small = compare_json(made_up_report(1, 10));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), std::count(small.begin(), small.end(), '\n') + 990);
}

// ---- CSV ----------------------------------------------------------------------------------------------------------------

// [RFC 4180], strictly: rows end with CR LF, quotes only around whole cells.
std::vector<std::vector<std::string>> read_csv(const std::string& text, std::vector<std::string>& complaints) {
  std::vector<std::vector<std::string>> rows{{""}};
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    std::string& cell = rows.back().back();
    const char c = text[i], next = i + 1 < text.size() ? text[i + 1] : '\0';
    if (quoted && c == '"' && next == '"')
      cell += '"', ++i;
    else if (quoted && c == '"')
      quoted = false;
    else if (quoted)
      cell += c;
    else if (c == '"' && cell.empty())
      quoted = true;
    else if (c == ',')
      rows.back().emplace_back();
    else if (c == '\r' && next == '\n')
      rows.push_back({""}), ++i;
    else if (c == '"' || c == '\r' || c == '\n')
      complaints.push_back("byte " + std::to_string(i));
    else
      cell += c;
  }
  rows.pop_back();
  return rows;
}

TEST(CompareCsv, HasARowForEachMeshAndFaceWithTheNumbersOfTheJson) {
  for (const CompareReport& report : all_reports()) {
    std::vector<std::string> complaints;
    const auto rows = read_csv(compare_csv(report), complaints);
    EXPECT_TRUE(complaints.empty()) << complaints.front();
    const json parsed = json::parse(compare_json(report));
    std::size_t expected = 1, row = 0;
    for (const ReportMesh& mesh : report.meshes) expected += 1 + mesh.comparison.faces.size();
    ASSERT_EQ(rows.size(), expected);
    const auto column = [&](const char* name) {
      const auto at = std::find(rows[0].begin(), rows[0].end(), name);
      EXPECT_NE(at, rows[0].end()) << name;
      return static_cast<std::size_t>(at - rows[0].begin());
    };
    for (const auto& cells : rows) ASSERT_EQ(cells.size(), rows[0].size());
    const auto same = [&](const char* name, const json& value) {
      EXPECT_EQ(rows[row][column(name)], value.is_null() ? "" : value.dump()) << name;
    };
    for (const json& mesh : parsed["meshes"]) {
      ++row;
      EXPECT_EQ(rows[row][column("scope")], "mesh");
      same("to_surface_max", mesh["to_surface"]["max"]);
      same("distance", mesh["distance"]["max"]);
      for (const json& face : mesh["faces"]) {
        ++row;
        EXPECT_EQ(rows[row][column("scope")], "face");
        EXPECT_EQ(rows[row][column("name")], valid_utf8(face["name"].get<std::string>()));
        same("distance", face["max"]);
        same("to_mesh_p99.9", face["to_mesh"]["p99.9"]);
        same("normal_angle_max", face["normal_angle"]["max"]);
        same("open_edges", face["open_edges"]);
      }
    }
  }
}

}  // namespace
}  // namespace iso::test
