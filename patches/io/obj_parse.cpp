// Parsing of OBJ statements into elements.
#include "patches/base/bspline_basis.h"
#include "patches/io/obj_elements.h"
#include "patches/io/text_input.h"

namespace iso {

namespace {

class ObjParser {
 public:
  ObjParser(const std::string& path, std::string_view text, PolygonsOfObj polygons) : path_(path), lines_(text), polygons_(polygons) {}

  ObjFile parse() {
    TextLine line;
    while (lines_.next(line)) statement(line);
    if (element_.kind != ObjElement::Kind::none)
      fail(path_, lines_.number(),
           "found the end of the file, expected `end` for the " + element_.keyword + " of line " + std::to_string(element_.line));
    file_.lines = lines_.number();
    return std::move(file_);
  }

 private:
  void statement(const TextLine& line) {
    const std::string_view key = line.words.front();
    if (key == "v")
      vertex(line);
    else if (key == "vp")
      parameter_vertex(line);
    else if (key == "cstype")
      curve_type(line);
    else if (key == "deg")
      degree(line);
    else if (key == "surf")
      begin_surface(line);
    else if (key == "curv2")
      begin_trim_curve(line);
    else if (key == "curv")
      begin(line, ObjElement::Kind::other);
    else if (key == "parm")
      parameters(line);
    else if (key == "trim" || key == "hole")
      loop(line);
    else if (key == "end")
      end(line);
    else if (polygons_ == PolygonsOfObj::read && key == "vn")
      normal(line);
    else if (polygons_ == PolygonsOfObj::read && (key == "f" || key == "fo"))
      polygon(line);
    else if (key == "o")
      object_ = rest(line);
    else if (key == "g")
      group_ = rest(line);
    else
      count(line);
  }

  // Statements that change no surface, and those that are not known.
  void count(const TextLine& line) {
    static constexpr std::string_view kOfOtherElements[] = {"vn", "vt", "s", "bmat", "step", "mg"};
    static constexpr std::string_view kCounted[] = {
        "f",   "fo",  "t",   "l",   "p",   "sp",    "scrv",     "con",      "usemtl", "mtllib", "usemap", "maplib",     "call",     "csh",
        "bsp", "bzp", "cdc", "cdp", "res", "bevel", "c_interp", "d_interp", "lod",    "ctech",  "stech",  "shadow_obj", "trace_obj"};
    const std::string_view key = line.words.front();
    for (const std::string_view k : kOfOtherElements)
      if (key == k) return;
    std::string name;
    for (const std::string_view k : kCounted)
      if (key == k) name = k;
    if (name.empty() && file_.first_unknown.empty()) file_.first_unknown = quoted(key);
    ObjCounted& c = file_.counted[name == "fo" ? "f" : name];
    if (c.count++ == 0) c.first_line = line.number;
  }

  void vertex(const TextLine& line) {
    // x y z, x y z w, x y z r g b, or x y z w r g b
    const std::size_t numbers = line.words.size() - 1;
    if (numbers != 3 && numbers != 4 && numbers != 6 && numbers != 7)
      fail(path_, line.number, "v has " + std::to_string(numbers) + " numbers, expected x y z and perhaps a weight");
    const bool weighted = numbers == 4 || numbers == 7;
    Vec4 p{0, 0, 0, 1};
    for (int c = 0; c < (weighted ? 4 : 3); ++c) p[c] = number(line, std::size_t(c) + 1, c < 3 ? "a coordinate" : "a weight");
    file_.vertices.push_back(p);
  }

  void parameter_vertex(const TextLine& line) {
    const std::size_t numbers = line.words.size() - 1;
    if (numbers < 1 || numbers > 3)
      fail(path_, line.number, "vp has " + std::to_string(numbers) + " numbers, expected u, u v or u v weight");
    Vec3 p{0, 0, 1};
    for (std::size_t c = 0; c < numbers; ++c) p[int(c)] = number(line, c + 1, "a number");
    file_.parameter_vertices.push_back(p);
  }

  void normal(const TextLine& line) {
    if (line.words.size() != 4) fail(path_, line.number, "vn has " + std::to_string(line.words.size() - 1) + " numbers, expected x y z");
    file_.normals.emplace_back(number(line, 1, "a coordinate"), number(line, 2, "a coordinate"), number(line, 3, "a coordinate"));
  }

  // Corners as "7", "7/1", "7//2" or "7/1/2": vertex, texture vertex, normal.
  void polygon(const TextLine& line) {
    ObjPolygon polygon{.line = line.number, .points = {}, .normals = {}, .name = element_name()};
    for (std::size_t i = 1; i < line.words.size(); ++i) {
      const std::string_view word = line.words[i];
      polygon.points.push_back(index(line, word, file_.vertices.size(), "a vertex"));
      const std::size_t second = word.find('/', std::min(word.find('/'), word.size() - 1) + 1);
      if (second != word.npos && word.find('/') != second)
        polygon.normals.push_back(index(line, word.substr(second + 1), file_.normals.size(), "a normal"));
    }
    if (polygon.normals.size() != polygon.points.size()) polygon.normals.clear();
    file_.polygons.push_back(std::move(polygon));
  }

  std::string element_name() const { return object_.empty() || group_.empty() ? object_ + group_ : object_ + "/" + group_; }

  void curve_type(const TextLine& line) {
    const bool rational = line.words.size() == 3 && line.words[1] == "rat";
    if (line.words.size() != (rational ? 3u : 2u))
      fail(path_, line.number, "found a cstype of " + std::to_string(line.words.size() - 1) + " words, expected [rat] and a type");
    const std::string type(line.words.back());
    bool known = false;
    for (const char* t : {"bezier", "bspline", "bmatrix", "cardinal", "taylor"}) known = known || type == t;
    if (!known) fail(path_, line.number, "found cstype " + quoted(type) + ", expected bezier, bspline, bmatrix, cardinal or taylor");
    now_.type = type;
    now_.rational = rational;
  }

  void degree(const TextLine& line) {
    if (line.words.size() != 2 && line.words.size() != 3)
      fail(path_, line.number, "found deg with " + std::to_string(line.words.size() - 1) + " numbers, expected one or two");
    const auto value = [&](std::size_t i) {
      const auto d = parse_integer(line.words[i]);
      if (!d || *d < 1 || *d > kMaxDegree)
        fail(path_, line.number, "found the degree " + quoted(line.words[i]) + ", expected 1 to " + std::to_string(kMaxDegree));
      return int(*d);
    };
    now_.degree_u = value(1);
    now_.degree_v = line.words.size() == 3 ? value(2) : 0;
  }

  void begin(const TextLine& line, ObjElement::Kind kind) {
    const std::string keyword(line.words.front());
    if (element_.kind != ObjElement::Kind::none)
      fail(path_, line.number,
           "found " + keyword + ", expected `end` for the " + element_.keyword + " of line " + std::to_string(element_.line));
    if (kind != ObjElement::Kind::other && now_.type.empty()) fail(path_, line.number, "found " + keyword + " before any cstype");
    element_ = {};
    element_.kind = kind;
    element_.line = line.number;
    element_.attributes = now_;
    element_.keyword = keyword;
    element_.name = element_name();
  }

  void begin_surface(const TextLine& line) {
    begin(line, ObjElement::Kind::surface);
    if (line.words.size() < 6)
      fail(path_, line.number, "surf has " + std::to_string(line.words.size() - 1) + " words, expected s0 s1 t0 t1 and the control points");
    element_.u = range(line, 1, "s0 < s1");
    element_.v = range(line, 3, "t0 < t1");
    for (std::size_t i = 5; i < line.words.size(); ++i)
      element_.points.push_back(index(line, line.words[i], file_.vertices.size(), "a vertex"));
  }

  void begin_trim_curve(const TextLine& line) {
    begin(line, ObjElement::Kind::trim_curve);
    for (std::size_t i = 1; i < line.words.size(); ++i)
      element_.points.push_back(index(line, line.words[i], file_.parameter_vertices.size(), "a parameter vertex"));
  }

  // parm u ... or parm v ...
  void parameters(const TextLine& line) {
    inside_element(line);
    const std::string_view which = line.words.size() > 1 ? line.words[1] : "";
    if (which != "u" && which != "v") fail(path_, line.number, "found parm " + quoted(which) + ", expected parm u or parm v");
    std::vector<double>& parm = which == "u" ? element_.parm_u : element_.parm_v;
    if (!parm.empty())
      fail(path_, line.number,
           "found a second parm " + std::string(which) + " in the " + element_.keyword + " of line " + std::to_string(element_.line));
    for (std::size_t i = 2; i < line.words.size(); ++i) parm.push_back(number(line, i, "a parameter"));
  }

  // trim or hole, and one or more times: u0 u1 curve
  void loop(const TextLine& line) {
    inside_element(line);
    const std::size_t numbers = line.words.size() - 1;
    if (numbers == 0 || numbers % 3 != 0)
      fail(path_, line.number, "found " + std::to_string(numbers) + " numbers, expected triples: start, end, trim curve");
    ObjLoop l;
    l.line = line.number;
    l.hole = line.words.front() == "hole";
    for (std::size_t i = 1; i < line.words.size(); i += 3)
      l.pieces.push_back({number(line, i, "a parameter"), number(line, i + 1, "a parameter"),
                          index(line, line.words[i + 2], file_.trim_curves.size(), "a trim curve")});
    element_.loops.push_back(std::move(l));
  }

  void end(const TextLine& line) {
    inside_element(line);
    if (element_.kind == ObjElement::Kind::surface) file_.surfaces.push_back(std::move(element_));
    if (element_.kind == ObjElement::Kind::trim_curve) file_.trim_curves.push_back(std::move(element_));
    if (element_.kind == ObjElement::Kind::other) {
      ObjCounted& c = file_.counted["curv"];
      if (c.count++ == 0) c.first_line = element_.line;
    }
    element_ = {};
  }

  void inside_element(const TextLine& line) const {
    if (element_.kind == ObjElement::Kind::none)
      fail(path_, line.number, "found " + std::string(line.words.front()) + " outside of surf, curv and curv2");
  }

  double number(const TextLine& line, std::size_t i, const std::string& expected) const {
    return number_in(path_, line.number, line.words[i], expected);
  }

  Range range(const TextLine& line, std::size_t i, const std::string& expected) const {
    const Range r{number(line, i, "a parameter"), number(line, i + 1, "a parameter")};
    if (!(r.lo < r.hi))
      fail(path_, line.number,
           "found the range " + std::string(line.words[i]) + " " + std::string(line.words[i + 1]) + ", expected " + expected);
    return r;
  }

  // The number (from 0) that "7", "7/1", "7/1/2" or "-1" refers to; whether it exists is checked when all is read.
  long index(const TextLine& line, std::string_view word, std::size_t so_far, const std::string& what) const {
    const auto i = parse_integer(word.substr(0, word.find('/')));
    if (!i || *i == 0) fail(path_, line.number, "found " + quoted(word) + ", expected the number of " + what);
    if (*i > 0) return *i - 1;
    if (-*i > long(so_far))
      fail(path_, line.number,
           "found " + quoted(word) + ", expected the number of " + what + "; there are " + std::to_string(so_far) + " up to here");
    return long(so_far) + *i;
  }

  static std::string rest(const TextLine& line) {
    std::string s;
    for (std::size_t i = 1; i < line.words.size(); ++i) s += (i > 1 ? " " : "") + std::string(line.words[i]);
    return s;
  }

  const std::string& path_;
  TextLines lines_;
  PolygonsOfObj polygons_;
  ObjFile file_;
  ObjAttributes now_;
  std::string object_, group_;
  ObjElement element_;
};

}  // namespace

ObjFile parse_obj(const std::string& path, std::string_view text, PolygonsOfObj polygons) {
  return ObjParser(path, text, polygons).parse();
}

}  // namespace iso
