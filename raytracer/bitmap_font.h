// A font of dots, five wide and seven high, with what legends need: digits, signs, and the letters of their words and units.
#pragma once

#include <string_view>

namespace iso {

inline constexpr int kGlyphWidth = 5, kGlyphHeight = 7;
inline constexpr int kGlyphAdvance = kGlyphWidth + 1;  // from one character to the next

// Whether the dot in this column and row (from the upper left) of a character is set. Characters the font does not have are blank.
bool glyph_dot(char c, int column, int row);

// All characters it has dots for.
std::string_view font_characters();

// Dots from the first to the last character's end.
int text_width(std::string_view text);

}  // namespace iso
