#include "patches/io/read_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "patches/io/patch_set.h"
#include "patches/io/text_check.h"
#include "patches/io/text_input.h"

namespace iso {
namespace {

enum class Format { step, iges, brep, obj, bpt, ipatch, gbp, lop, mp, unknown };
constexpr const char* kExpected = "expected STEP, IGES, BREP, OBJ, .bpt, .ipatch, .gbp, .lop or .mp";
constexpr std::streamsize kHead = 4096;  // bytes that decide what a file is

bool starts_with(const std::string& text, const char* start) { return text.rfind(start, 0) == 0; }

std::string lower(std::string s) {
  for (char& c : s) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return s;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines(1);
  for (const char c : text) {
    if (c == '\n')
      lines.emplace_back();
    else if (c != '\r')
      lines.back() += c;
  }
  return lines;
}

// An IGES line has 72 columns of text, the letter of its section, and its number.
bool is_iges_line(const std::string& line) {
  if (line.size() < 74 || line.size() > 82 || std::string("SBCFGD").find(line[72]) == std::string::npos) return false;
  return std::all_of(line.begin() + 73, line.end(), [](char c) { return c == ' ' || std::isdigit(static_cast<unsigned char>(c)); });
}

// OBJ: its first statement is one of the format's keywords.
bool is_obj(const std::vector<std::string>& lines) {
  static constexpr const char* kWords[] = {"v",      "vt", "vn",     "vp",     "f",   "l",    "p",    "g",    "o",     "s",
                                           "mtllib", "t",  "usemtl", "cstype", "deg", "bmat", "surf", "curv", "curv2", "call"};
  for (const std::string& line : lines) {
    const size_t start = line.find_first_not_of(" \t");
    if (start == std::string::npos || line[start] == '#') continue;
    const std::string word = line.substr(start, line.find_first_of(" \t", start) - start);
    return std::find_if(std::begin(kWords), std::end(kWords), [&](const char* w) { return word == w; }) != std::end(kWords);
  }
  return false;
}

// .bpt: a count alone on the first line, two degrees on the second.
bool is_bpt(const std::vector<std::string>& lines) {
  const auto only_integers = [](const std::string& line, int wanted) {
    int found = 0;
    for (size_t i = 0; i < line.size();) {
      if (std::isspace(static_cast<unsigned char>(line[i]))) {
        ++i;
        continue;
      }
      const size_t from = i;
      while (i < line.size() && std::isdigit(static_cast<unsigned char>(line[i]))) ++i;
      if (i == from) return false;
      ++found;
    }
    return found == wanted;
  };
  return lines.size() >= 2 && only_integers(lines[0], 1) && only_integers(lines[1], 2);
}

// .ipatch: JSON that calls itself so.
bool is_ipatch(const std::string& head) {
  const std::size_t start = head.find_first_not_of(" \t\r\n");
  return start != head.npos && head[start] == '{' && head.find('"' + std::string(kPatchFileFormat) + '"') != head.npos;
}

Format format_of_content(const std::string& head) {
  if (head.find("ISO-10303-21") != std::string::npos) return Format::step;
  if (head.find("DBRep_DrawableShape") != std::string::npos || head.find("CASCADE Topology V") != std::string::npos) return Format::brep;
  const auto lines = lines_of(head);
  if (is_iges_line(lines[0])) return Format::iges;
  if (head.find('\0') != std::string::npos) return Format::unknown;
  if (is_ipatch(head)) return Format::ipatch;
  if (is_bpt(lines)) return Format::bpt;
  if (is_obj(lines)) return Format::obj;
  return Format::unknown;
}

// Where the content does not tell, the reader that the name asks for gives the better message.
Format format_of_name(const std::string& path) {
  const std::string ending = lower(std::filesystem::path(path).extension().string());
  if (ending == ".obj") return Format::obj;
  if (ending == ".bpt") return Format::bpt;
  if (ending == ".ipatch") return Format::ipatch;
  if (ending == ".gbp") return Format::gbp;
  if (ending == ".lop") return Format::lop;
  if (ending == ".mp") return Format::mp;
  return Format::unknown;
}

// Files of numbers alone look alike, and ribbons (.mp) begin like a .bpt file: among these the name decides.
Format format_of(const std::string& path, const std::string& head) {
  const Format content = format_of_content(head), name = format_of_name(path);
  const bool numbers = name == Format::gbp || name == Format::lop || name == Format::mp;
  return content == Format::unknown || (content == Format::bpt && numbers) ? name : content;
}

// What a file that we cannot use seems to be.
std::string describe(const std::string& head) {
  if (starts_with(head, "Open CASCADE Topology")) return "a binary BREP file (only the text form can be read)";
  if (starts_with(head, "solid")) return "an STL mesh (a mesh has no exact surfaces)";
  if (starts_with(head, "ply")) return "a PLY mesh (a mesh has no exact surfaces)";
  if (starts_with(head, "glTF")) return "a glTF mesh (a mesh has no exact surfaces)";
  if (starts_with(head, "PK\x03\x04")) return "a zip archive";
  if (starts_with(head, "\x1f\x8b")) return "a gzip archive";
  if (starts_with(head,
                  "\x7f"
                  "ELF"))
    return "a program";
  const bool text =
      std::all_of(head.begin(), head.end(), [](char c) { return c == '\t' || c == '\n' || c == '\r' || (c >= ' ' && c <= '~'); });
  return text ? "text of another kind" : "binary data";
}

Result<std::string> read_head(const std::string& path) {
  std::error_code code;
  const auto status = std::filesystem::status(path, code);
  if (!std::filesystem::exists(status)) return read_write_error(path, "no such file");
  if (std::filesystem::is_directory(status)) return read_write_error(path, fmt::format("is a directory; {}", kExpected));
  if (!std::filesystem::is_regular_file(status)) return read_write_error(path, "is not a regular file");
  errno = 0;
  std::ifstream in(path, std::ios::binary);
  if (!in) return read_write_error(path, fmt::format("cannot be read: {}", std::strerror(errno)));
  std::string head(static_cast<size_t>(kHead), '\0');
  in.read(head.data(), kHead);
  if (in.bad()) return read_write_error(path, fmt::format("cannot be read: {}", std::strerror(errno)));
  head.resize(static_cast<size_t>(in.gcount()));
  return head;
}

Status check_text_of(const std::string& path, Status (*check)(const std::string&, std::string_view)) {
  const auto text = read_text(path);
  return text ? check(path, *text) : Status(text.error());
}

Result<Model> read_as(Format format, const std::string& path, const std::string& head, const ReadOptions& options) {
  if (options.patches && format != Format::obj)
    return bad_input(path, "", "patches are made of control meshes (--patches), expected an OBJ file with polygons");
  switch (format) {
    case Format::step:
      if (const auto checked = check_text_of(path, check_step_text); !checked) return checked.error();
      return read_step(path);
    case Format::iges:
      return read_iges(path);
    case Format::brep:
      if (const auto checked = check_text_of(path, check_brep_text); !checked) return checked.error();
      return read_brep(path);
    case Format::obj:
      return read_obj(path, options);
    case Format::bpt:
      return read_bpt(path);
    case Format::ipatch:
      return read_ipatch(path);
    case Format::gbp:
      return read_gbp(path);
    case Format::lop:
      return read_lop(path);
    case Format::mp:
      return read_mp(path);
    case Format::unknown:
      break;
  }
  return bad_input(path, "", fmt::format("{}; found {}", kExpected, describe(head)));
}

// A tolerance that is no number would let a face reach anywhere.
void mend_tolerances(Model& model) {
  for (Part& part : model.parts)
    for (Edge& edge : part.edges) {
      if (std::isfinite(edge.file_tolerance) && edge.file_tolerance >= 0) continue;
      edge.file_tolerance = 0;
      model.report(Problem::Kind::repaired, "part '" + part.name + "'", "edge with a tolerance that is not finite or negative: taken as 0");
    }
}

// Why nothing is left: what was dropped and what was there instead of faces.
std::string reason_for_no_faces(const Model& model) {
  constexpr size_t kTold = 3;
  std::string text = "no faces that can be used";
  size_t told = 0;
  for (const Problem& p : model.problems) {
    if (p.kind != Problem::Kind::dropped && p.kind != Problem::Kind::note) continue;
    if (told++ == kTold) return text + "; ...";
    text += fmt::format("{} {}: {}", told == 1 ? ":" : ";", p.entity, p.what);
  }
  return told > 0 ? text : text + ": nothing in the file became a shape";
}

}  // namespace

Result<Model> read_model(const std::string& path, const ReadOptions& options) {
  const auto head = read_head(path);
  if (!head) return head.error();
  if (head->empty()) return bad_input(path, "", fmt::format("{}; found an empty file", kExpected));
  auto model = read_as(format_of(path, *head), path, *head, options);
  if (!model) return model;
  size_t faces = 0;
  for (const Instance& instance : model->instances) faces += model->parts[static_cast<size_t>(instance.part)].faces.size();
  if (faces == 0) return bad_input(path, "", reason_for_no_faces(*model));
  mend_tolerances(*model);
  finish(*model);
  // Trim loops may leave nothing of any face.
  if (const Box3 box = box_of(*model); box.empty() || !finite(box.lo) || !finite(box.hi))
    return bad_input(path, "", box.empty() ? "the trim loops leave nothing of its faces" : "the size of the model is not finite");
  return model;
}

}  // namespace iso
