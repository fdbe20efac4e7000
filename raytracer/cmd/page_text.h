// Words and numbers for pages that a browser shows: escaped, readable, and with the whole number behind the rounded one.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "patches/base/vec.h"

namespace iso {

// UTF-8 in which bytes that are none, and control characters but tab and line feed, are replaced by U+FFFD.
std::string valid_utf8(std::string_view text);

// The same, safe in HTML as text and in quoted attributes.
std::string escaped(std::string_view text);

// A file's name as the relative address of a link.
std::string link_to(std::string_view file);

// At most `count` characters, the last of them an ellipsis if some are left out.
std::string shortened(std::string_view text, std::size_t count);

// Three significant digits: "0.0123", "1.23e-5", "12 300"; "0", "unknown" for NaN, "infinite".
std::string figure_text(double x);
std::string count_text(std::uint64_t n);  // "48 310", with narrow blanks that do not break
std::string bytes_text(std::uint64_t n);  // "3.96 MB"

// The number as JSON has it; empty if it is not finite.
std::string json_number(double x);

// <data value="0.012345">0.0123</data>: rounded for reading, whole in the attribute. What is not finite has no attribute to hold it, and
// is a plain word.
std::string shown(double x);
std::string shown(double x, std::string_view text);
std::string shown_count(std::uint64_t n);
std::string shown_bytes(std::uint64_t n);  // the value is in bytes

std::string hex_of(const Colour& display);  // "#1f77b4", of display-encoded values from 0 to 1

std::string base64(std::string_view bytes);

}  // namespace iso
