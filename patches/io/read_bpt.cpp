// Newell's .bpt patch sets: the number of patches; for each patch a line with its two degrees and (degree u + 1)(degree v + 1) lines
// x y z, u running fastest. Every patch becomes a face over [0, 1]^2 without trim loops.
// Damaged files are refused with the line; whatever follows the last patch is reported.
#include "patches/base/bspline_basis.h"
#include "patches/io/read_model.h"
#include "patches/io/text_input.h"

namespace iso {

namespace {

// Hands out lines that must be there and must hold a given number of words.
class BptLines {
 public:
  BptLines(const std::string& path, std::string_view text) : path_(path), lines_(text) {}

  const TextLine& expect(std::size_t words, const std::string& where, const std::string& expected) {
    if (!lines_.next(line_)) fail(path_, lines_.number(), where + "found the end of the file, expected " + expected);
    if (line_.words.size() != words) {
      std::string found = std::to_string(line_.words.size()) + " words from " + quoted(line_.words.front()) + " on";
      fail(path_, line_.number, where + "found " + found + ", expected " + expected);
    }
    return line_;
  }
  bool next(TextLine& line) { return lines_.next(line); }

 private:
  const std::string& path_;
  TextLines lines_;
  TextLine line_;
};

long integer_in(const std::string& path, int line, std::string_view word, long least, long most, const std::string& expected) {
  const auto value = parse_integer(word);
  if (!value || *value < least || *value > most) fail(path, line, "found " + quoted(word) + ", expected " + expected);
  return *value;
}

NurbsSurface read_patch(const std::string& path, BptLines& lines, const std::string& where) {
  const std::string degrees = "two degrees from 1 to " + std::to_string(kMaxDegree);
  const TextLine& head = lines.expect(2, where, degrees);
  NurbsSurface s;
  s.degree_u = int(integer_in(path, head.number, head.words[0], 1, kMaxDegree, degrees));
  s.degree_v = int(integer_in(path, head.number, head.words[1], 1, kMaxDegree, degrees));
  s.count_u = s.degree_u + 1;
  s.count_v = s.degree_v + 1;

  // The file runs through u first, the surface stores v first.
  const int points = s.count_u * s.count_v;
  s.poles.resize(std::size_t(points));
  for (int k = 0; k < points; ++k) {
    const std::string here = where + "point " + std::to_string(k + 1) + " of " + std::to_string(points) + ": ";
    const TextLine& line = lines.expect(3, here, "three numbers x y z");
    Vec4& pole = s.poles[std::size_t((k % s.count_u) * s.count_v + k / s.count_u)];
    for (int c = 0; c < 3; ++c)
      pole[c] = number_in(path, line.number, line.words[std::size_t(c)], "a coordinate of " + here.substr(0, here.size() - 2));
    pole.w = 1;
  }

  // Bezier knots: 0 and 1, each degree + 1 times.
  const auto bezier_knots = [](int degree) {
    std::vector<double> knots(std::size_t(2 * degree + 2), 0.0);
    std::fill(knots.begin() + degree + 1, knots.end(), 1.0);
    return knots;
  };
  s.knots_u = bezier_knots(s.degree_u);
  s.knots_v = bezier_knots(s.degree_v);
  return s;
}

Model parse_bpt(const std::string& path, std::string_view text) {
  Model model;
  model.file = path;
  model.format = "BPT";
  Part part;
  part.name = stem_of(path);

  BptLines lines(path, text);
  const std::string expected = "the number of patches";
  const TextLine& head = lines.expect(1, "", expected);
  const long count = integer_in(path, head.number, head.words[0], 1, 100'000'000, expected);
  for (long i = 1; i <= count; ++i) {
    Face face;
    face.name = "patch " + std::to_string(i);
    face.surface = read_patch(path, lines, face.name + " of " + std::to_string(count) + ": ");
    face.domain = {Vec2(0.0), Vec2(1.0)};
    part.faces.push_back(std::move(face));
  }

  // More lines than the number of patches announced.
  TextLine extra;
  if (lines.next(extra)) {
    Problem problem{Problem::Kind::dropped, "line " + std::to_string(extra.number), "lines after the last patch", 1};
    while (lines.next(extra)) ++problem.count;
    model.problems.push_back(std::move(problem));
  }

  Instance instance;
  instance.name = part.name;
  model.parts.push_back(std::move(part));
  model.instances.push_back(std::move(instance));
  return model;
}

}  // namespace

Result<Model> read_bpt(const std::string& path) {
  const auto text = read_text(path);
  if (!text) return text.error();
  try {
    return parse_bpt(path, *text);
  } catch (const Error& error) {
    return error;
  }
}

}  // namespace iso
