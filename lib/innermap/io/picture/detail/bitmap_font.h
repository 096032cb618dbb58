// A 5 x 7 bitmap font for printable ASCII, for machines without any font.
#pragma once

#include <array>
#include <cstdint>

namespace innermap {

constexpr int kGlyphWidth = 5, kGlyphHeight = 7;

// Rows from top to bottom; bit 4 is the leftmost pixel. '?' for other characters.
const std::array<std::uint8_t, kGlyphHeight>& glyph(char c);

}  // namespace innermap
