#include "patches/io/text_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <unordered_set>
#include <vector>

#include "patches/io/text_input.h"

namespace iso {
namespace {

// Programs write 1e100 or 2e100 for infinity; squares of what is larger overflow. Searching the nearest point of a surface with a pole
// beyond 1e33, Open CASCADE loops for ever; our readers take no coordinate beyond kLargestNumber.
constexpr double kLargestInFile = 1e120, kLargestCoordinate = 1e30;

int line_at(std::string_view text, std::size_t at) {
  return 1 + static_cast<int>(std::count(text.begin(), text.begin() + static_cast<long>(at), '\n'));
}

bool is_blank(char c) { return std::isspace(static_cast<unsigned char>(c)) != 0 || c == '\0'; }

// "nan", "-INF", "1.#QNAN": what programs print for numbers that are none.
bool is_no_number(std::string_view word) {
  std::string lower;
  for (const char c : word.substr(0, 8)) lower += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  std::string_view rest = lower;
  if (!rest.empty() && (rest[0] == '+' || rest[0] == '-')) rest.remove_prefix(1);
  return rest.starts_with("nan") || rest.starts_with("inf") || rest.find(".#") != rest.npos;
}

// A number as far as it goes, so "1.E+0390." counts as the one that C reads from it.
bool is_too_large(std::string_view word, double largest) {
  if (word.empty() || word.find_first_of("eE") == word.npos) return false;
  return std::abs(std::strtod(std::string(word).c_str(), nullptr)) > largest;
}

// The word of letters, digits and underscores that ends before `at`; empty if there is none.
std::string_view name_before(std::string_view text, std::size_t at) {
  std::size_t begin = at;
  while (begin > 0 && (std::isalnum(static_cast<unsigned char>(text[begin - 1])) || text[begin - 1] == '_')) --begin;
  return text.substr(begin, at - begin);
}

// Where a string or comment that begins at `at` ends (one past it); `at` if none begins there. Doubled quotes belong to the string, which
// then simply goes on as another one.
std::size_t past_quotes(std::string_view text, std::size_t at) {
  if (text[at] == '\'' || text[at] == '"') return std::min(text.find(text[at], at + 1), text.size() - 1) + 1;
  if (text.substr(at, 2) == "/*") return std::min(text.find("*/", at + 2), text.size() - 2) + 2;
  return at;
}

// The format's own words: names of sections and of shape types, continuities, and flags such as "0101000" (numbers anyway).
constexpr std::array kBrepWords{"DBRep_DrawableShape",
                                "CASCADE",
                                "Topology",
                                "V1,",
                                "V1",
                                "V2,",
                                "V2",
                                "V3,",
                                "V3",
                                "(c)",
                                "Matra-Datavision",
                                "Open",
                                "Cascade",
                                "Locations",
                                "Curve2ds",
                                "Curves",
                                "Polygon3D",
                                "PolygonOnTriangulations",
                                "Surfaces",
                                "Triangulations",
                                "TShapes",
                                "p",
                                "Ve",
                                "Ed",
                                "Wi",
                                "Fa",
                                "Sh",
                                "So",
                                "CS",
                                "Co",
                                "*",
                                "C0",
                                "C1",
                                "C2",
                                "C3",
                                "CN",
                                "G1",
                                "G2"};

bool is_brep_word(std::string_view word) {
  const auto known = [](std::string_view w) { return std::find(kBrepWords.begin(), kBrepWords.end(), w) != kBrepWords.end(); };
  if (known(word) || parse_number(word)) return true;
  if ((word[0] == 'i' || word[0] == 'e') && parse_integer(word.substr(1))) return true;  // a sub-shape that is internal or external
  // A continuity stands right against the number before it: "14CN".
  const std::size_t letter = word.find_first_not_of("0123456789");
  return letter != word.npos && letter > 0 && word.size() - letter == 2 && known(word.substr(letter));
}

}  // namespace

namespace {

// Every entity is defined once, and every reference is to one that is defined: where they are not, Open CASCADE may loop for ever while it
// numbers the entities, depending on what its memory held before.
Status check_step_references(const std::string& path, std::string_view text) {
  std::unordered_set<std::string_view> defined;
  std::vector<std::string_view> references;
  for (std::size_t at = 0; at < text.size();) {
    if (const std::size_t past = past_quotes(text, at); past != at) {
      at = past;
      continue;
    }
    if (text[at++] != '#') continue;
    std::size_t begin = at;
    while (begin + 1 < text.size() && text[begin] == '0') ++begin;
    const std::size_t end = std::min(text.find_first_not_of("0123456789", begin), text.size());
    if (end == at) continue;
    const std::string_view number = text.substr(begin, end - begin);
    at = end;
    while (at < text.size() && is_blank(text[at])) ++at;
    if (at == text.size() || text[at] != '=')
      references.push_back(number);
    else if (!defined.insert(number).second)
      return bad_input(path, std::to_string(line_at(text, begin)), fmt::format("damaged STEP file: entity #{} is defined twice", number));
  }
  for (const std::string_view number : references)
    if (!defined.contains(number))
      return bad_input(path, std::to_string(line_at(text, static_cast<std::size_t>(number.data() - text.data()))),
                       fmt::format("damaged STEP file: found #{}, expected an entity that is defined in the file", number));
  return Done{};
}

}  // namespace

Status check_step_text(const std::string& path, std::string_view text) {
  // Values stand after '(' or ',' and end before ',' or ')'.
  std::string_view type;
  for (std::size_t at = 0; at < text.size();) {
    if (const std::size_t past = past_quotes(text, at); past != at) {
      at = past;
      continue;
    }
    if (text[at] != '(' && text[at] != ',') {
      ++at;
      continue;
    }
    if (const auto name = name_before(text, at); text[at] == '(' && !name.empty()) type = name;
    std::size_t begin = at + 1;
    while (begin < text.size() && is_blank(text[begin])) ++begin;
    const std::size_t end = std::min(text.find_first_of(",()'\"/;", begin), text.size());
    const std::string_view word = text.substr(begin, end - begin);
    // A name before '(' is a type, such as INFO(...).
    if (is_no_number(word) && (end == text.size() || text[end] != '('))
      return bad_input(path, std::to_string(line_at(text, begin)), "found " + quoted(word) + ", expected a number");
    if (is_too_large(word, type == "CARTESIAN_POINT" ? kLargestCoordinate : kLargestInFile))
      return bad_input(path, std::to_string(line_at(text, begin)), "found " + quoted(word) + ", expected a number of sensible size");
    at = begin;
  }
  return check_step_references(path, text);
}

Status check_brep_text(const std::string& path, std::string_view text) {
  for (std::size_t at = 0; at < text.size();) {
    if (is_blank(text[at])) {
      ++at;
      continue;
    }
    std::size_t end = at;
    while (end < text.size() && !is_blank(text[end])) ++end;
    const std::string_view word = text.substr(at, end - at);
    if (!is_brep_word(word))
      return bad_input(path, std::to_string(line_at(text, at)),
                       "damaged BREP file: found " + quoted(word) + ", expected a number or a keyword");
    at = end;
  }
  return Done{};
}

}  // namespace iso
