#include "raytracer/cmd/page_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace iso {
namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD", kNarrowBlank = "\xE2\x80\xAF", kEllipsis = "\xE2\x80\xA6";

// The character that `text` begins with, or the bytes that are the longest beginning of one but none. [Unicode 15, table 3-7 and 3.9]
struct Sequence {
  std::size_t size = 1;
  bool valid = false;
};
Sequence sequence_at(std::string_view text) {
  const auto first = static_cast<unsigned char>(text[0]);
  if (first < 0x80) return {1, true};
  const std::size_t size = first >= 0xC2 && first <= 0xDF ? 2 : first >= 0xE0 && first <= 0xEF ? 3 : first >= 0xF0 && first <= 0xF4 ? 4 : 1;
  unsigned lo = first == 0xE0 ? 0xA0 : first == 0xF0 ? 0x90 : 0x80, hi = first == 0xED ? 0x9F : first == 0xF4 ? 0x8F : 0xBF;
  for (std::size_t i = 1; i < size; ++i, lo = 0x80, hi = 0xBF) {
    const unsigned byte = i < text.size() ? static_cast<unsigned char>(text[i]) : 0;
    if (byte < lo || byte > hi) return {i, false};
  }
  return {size, size > 1};
}

// Characters that XML or a terminal would stumble over: C0 but tab and line feed, DEL and C1.
bool is_control(std::string_view sequence) {
  const auto first = static_cast<unsigned char>(sequence[0]);
  if (sequence.size() == 1) return (first < 0x20 && first != '\t' && first != '\n') || first == 0x7F;
  return sequence.size() == 2 && first == 0xC2 && static_cast<unsigned char>(sequence[1]) < 0xA0;
}

}  // namespace

std::string valid_utf8(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size();) {
    const Sequence sequence = sequence_at(text.substr(i));
    const std::string_view bytes = text.substr(i, sequence.size);
    out += !sequence.valid || is_control(bytes) ? kReplacement : bytes;
    i += sequence.size;
  }
  return out;
}

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : valid_utf8(text)) switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        out += c;
    }
  return out;
}

std::string link_to(std::string_view file) {
  std::string out = "./";
  for (const char c : file) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_' || c == '.';
    out += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return out;
}

std::string shortened(std::string_view text, std::size_t count) {
  const std::string valid = valid_utf8(text);
  std::size_t seen = 0, cut = 0;
  for (std::size_t i = 0; i < valid.size(); i += sequence_at(std::string_view(valid).substr(i)).size) {
    if (seen + 1 == count) cut = i;
    if (++seen > count) return valid.substr(0, cut) + std::string(kEllipsis);
  }
  return valid;
}

std::string count_text(std::uint64_t n) {
  std::string digits = std::to_string(n), out;
  for (std::size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && (digits.size() - i) % 3 == 0 && digits.size() > 4) out += kNarrowBlank;
    out += digits[i];
  }
  return out;
}

std::string figure_text(double x) {
  if (std::isnan(x)) return "unknown";
  if (std::isinf(x)) return x > 0 ? "infinite" : "-infinite";
  constexpr double kGroupedFrom = 999.5, kExponentFrom = 1e7;
  const double size = std::abs(x);
  if (size >= kGroupedFrom && size < kExponentFrom) {
    // Three digits count, the others are zeros.
    const double unit = std::pow(10.0, std::floor(std::log10(size)) - 2);
    return (x < 0 ? "-" : "") + count_text(static_cast<std::uint64_t>(std::llround(std::round(size / unit) * unit)));
  }
  // "1.23e-05" is "1.23e-5".
  std::string text = fmt::format("{:.3g}", x);
  if (const std::size_t e = text.find('e'); e != std::string::npos) {
    std::size_t digits = e + 2;
    while (digits + 1 < text.size() && text[digits] == '0') text.erase(digits, 1);
    if (text[e + 1] == '+') text.erase(e + 1, 1);
  }
  return text;
}

std::string json_number(double x) { return std::isfinite(x) ? nlohmann::json(x).dump() : std::string{}; }

std::string shown(double x, std::string_view text) {
  if (!std::isfinite(x)) return std::string(text);
  return fmt::format("<data value=\"{}\">{}</data>", json_number(x), text);
}
std::string shown(double x) { return shown(x, figure_text(x)); }
std::string shown_count(std::uint64_t n) { return fmt::format("<data value=\"{}\">{}</data>", n, count_text(n)); }

std::string bytes_text(std::uint64_t n) {
  const auto x = static_cast<double>(n);
  if (n < 1000) return fmt::format("{} bytes", n);
  if (n < 1000000) return figure_text(1e-3 * x) + " kB";
  return x < 1e9 ? figure_text(1e-6 * x) + " MB" : figure_text(1e-9 * x) + " GB";
}
std::string shown_bytes(std::uint64_t n) { return fmt::format("<data value=\"{}\">{}</data>", n, bytes_text(n)); }

std::string hex_of(const Colour& display) {
  const auto level = [](float x) { return static_cast<int>(std::lround(255 * std::clamp(std::isfinite(x) ? x : 0.0f, 0.0f, 1.0f))); };
  return fmt::format("#{:02x}{:02x}{:02x}", level(display.r), level(display.g), level(display.b));
}

std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const auto byte = [&](std::size_t k) { return i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u; };
    const unsigned block = byte(0) << 16 | byte(1) << 8 | byte(2);
    for (unsigned k = 0; k < 4; ++k) out += i + k <= bytes.size() ? kDigits[block >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

}  // namespace iso
