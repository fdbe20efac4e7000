#include "raytracer/ray_text.h"

#include <fmt/compile.h>
#include <fmt/format.h>

#include <array>
#include <charconv>
#include <iterator>
#include <nlohmann/json.hpp>

namespace iso {
namespace {

// Beyond these lengths squares of the components would leave the range of double.
constexpr double kShortest = 1e-100, kLongest = 1e100;

std::string_view skip_blanks(std::string_view text) {
  const auto at = text.find_first_not_of(" \t\r\v\f");
  return at == std::string_view::npos ? std::string_view{} : text.substr(at);
}

std::string quoted(std::string_view text) {
  constexpr std::size_t kMost = 30;
  std::string shown;
  for (const char c : text.substr(0, kMost)) shown += (static_cast<unsigned char>(c) < 32 || static_cast<unsigned char>(c) > 126) ? '?' : c;
  return "'" + shown + (text.size() > kMost ? "...'" : "'");
}

// The name as one word.
std::string word(const std::string& name) {
  std::string text = name.empty() ? "-" : name;
  for (char& c : text)
    if (static_cast<unsigned char>(c) <= 32 || c == 127) c = '_';
  return text;
}

void append_number(std::string& out, double x) {
  if (std::isfinite(x))
    fmt::format_to(std::back_inserter(out), FMT_COMPILE("{:.17g}"), x);
  else
    out += "null";
}
void append_list(std::string& out, const char* key, std::initializer_list<double> values) {
  out += key;
  bool first = true;
  for (const double x : values) {
    if (!first) out += ',';
    append_number(out, x);
    first = false;
  }
  out += ']';
}

}  // namespace

bool is_skipped(std::string_view line) {
  const std::string_view rest = skip_blanks(line);
  return rest.empty() || rest.front() == '#';
}

Result<Ray> parse_ray(std::string_view line) {
  // Six numbers, nothing after them.
  std::array<double, 6> x{};
  std::string_view rest = skip_blanks(line);
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (rest.empty()) return bad_input({}, {}, fmt::format("found {} numbers, expected six: ox oy oz dx dy dz", i));
    const std::size_t plus = rest.size() > 1 && rest[0] == '+' && rest[1] != '-' ? 1 : 0;
    const auto [end, code] = std::from_chars(rest.data() + plus, rest.data() + rest.size(), x[i]);
    const std::string_view word_here = rest.substr(0, rest.find_first_of(" \t\r\v\f"));
    if (code != std::errc{} || end != word_here.data() + word_here.size())
      return bad_input({}, {}, fmt::format("found {}, expected a number (ox oy oz dx dy dz)", quoted(word_here)));
    if (!std::isfinite(x[i])) return bad_input({}, {}, fmt::format("found {}, expected a finite number", quoted(word_here)));
    rest = skip_blanks(rest.substr(word_here.size()));
  }
  if (!rest.empty()) return bad_input({}, {}, fmt::format("found {} after the sixth number, expected the end of the line", quoted(rest)));

  const Ray ray{{x[0], x[1], x[2]}, {x[3], x[4], x[5]}};
  const double largest = std::max({std::abs(x[3]), std::abs(x[4]), std::abs(x[5])});
  if (largest == 0) return bad_input({}, {}, "found the direction 0 0 0, expected one that is not zero");
  if (largest < kShortest || largest > kLongest)
    return bad_input({}, {}, fmt::format("found a direction of length {:g}, expected {:g} to {:g}", largest, kShortest, kLongest));
  if (std::max({std::abs(x[0]), std::abs(x[1]), std::abs(x[2])}) > kLongest)
    return bad_input({}, {}, fmt::format("found an origin beyond {:g}", kLongest));
  return ray;
}

void append_hit(std::string& out, HitFormat format, std::uint64_t ray, const Tracer& tracer, const Hit& hit) {
  const SurfacePoint at = tracer.surface_point(hit);
  const std::string& name = tracer.face(hit).name;
  if (format == HitFormat::text) {
    fmt::format_to(std::back_inserter(out), FMT_COMPILE("{}"), ray);
    for (const double x : {hit.t, at.p.x, at.p.y, at.p.z, at.n.x, at.n.y, at.n.z, hit.uv.x, hit.uv.y})
      fmt::format_to(std::back_inserter(out), FMT_COMPILE(" {:.17g}"), x);
    for (const double k : {at.k1, at.k2})
      if (std::isnan(k))
        out += " nan";  // never "-nan"
      else
        fmt::format_to(std::back_inserter(out), FMT_COMPILE(" {:.17g}"), k);
    fmt::format_to(std::back_inserter(out), FMT_COMPILE(" {} {} {}\n"), hit.placed, hit.face, word(name));
    return;
  }
  fmt::format_to(std::back_inserter(out), FMT_COMPILE("{{\"ray\":{},\"t\":"), ray);
  append_number(out, hit.t);
  append_list(out, ",\"p\":[", {at.p.x, at.p.y, at.p.z});
  append_list(out, ",\"n\":[", {at.n.x, at.n.y, at.n.z});
  append_list(out, ",\"uv\":[", {hit.uv.x, hit.uv.y});
  append_list(out, ",\"k\":[", {at.k1, at.k2});
  const auto escaped = nlohmann::json(name).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  fmt::format_to(std::back_inserter(out), FMT_COMPILE(",\"instance\":{},\"face\":{},\"name\":{}}}\n"), hit.placed, hit.face, escaped);
}

void append_miss(std::string& out, HitFormat format, std::uint64_t ray) {
  if (format == HitFormat::text)
    fmt::format_to(std::back_inserter(out), FMT_COMPILE("{} miss\n"), ray);
  else
    fmt::format_to(std::back_inserter(out), FMT_COMPILE("{{\"ray\":{},\"miss\":true}}\n"), ray);
}

}  // namespace iso
