// The legend is read back from its pixels: text by the font, colours by the scale.
#include "raytracer/legend.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <set>

#include "raytracer/bitmap_font.h"
#include "raytracer/image_io.h"
#include "tests/support/child.h"

namespace iso::test {
namespace {

glm::vec4 pixel(const Film& film, int x, int y) {
  return film.rgba[static_cast<std::size_t>(y) * static_cast<std::size_t>(film.size().width) + static_cast<std::size_t>(x)];
}

// The character whose dots are those of the picture at a place; '?' if there is none.
char character_at(const Film& film, int x, int y, int dot) {
  for (const char c : font_characters()) {
    bool same = true;
    for (int row = 0; row < kGlyphHeight; ++row)
      for (int column = 0; column < kGlyphWidth; ++column)
        same = same && glyph_dot(c, column, row) == (pixel(film, x + column * dot + dot / 2, y + row * dot + dot / 2).r > 0.9f);
    if (same) return c;
  }
  return '?';
}

std::string text_in(const Film& film, const LegendText& text, int dot) {
  std::string read;
  for (std::size_t i = 0; i < text.text.size(); ++i)
    read += character_at(film, text.x + static_cast<int>(i) * kGlyphAdvance * dot, text.y, dot);
  return read;
}

Film grey_film(const ImageSize& size) {
  Film film(size, kAovNone);
  for (glm::vec4& p : film.rgba) p = {0.4f, 0.4f, 0.4f, 1.0f};
  return film;
}

TEST(Legend, NumbersInThePictureAreTheValuesAtTheirTicks) {
  int numbers = 0;
  for (const ImageSize size : {ImageSize{640, 480}, ImageSize{160, 120}, ImageSize{1280, 960}, ImageSize{301, 263}})
    for (const Range range : {Range{-0.02, 0.02}, Range{-5e-7, 5e-7}, Range{0, 3}, Range{-1, 4}, Range{-2e6, 2e6}, Range{1e-3, 1.25e-3}}) {
      const Legend legend{"gauss curvature", {range}};
      Film film = grey_film(size);
      const auto layout = layout_of(legend, size);
      ASSERT_TRUE(layout) << size.width << " " << range.lo;
      ASSERT_TRUE(draw_legend(legend, film));
      ASSERT_EQ(layout->numbers.size(), layout->ticks.size());
      ASSERT_GE(layout->numbers.size(), 2u);
      for (std::size_t i = 0; i < layout->numbers.size(); ++i, ++numbers) {
        const std::string text = text_in(film, layout->numbers[i], layout->dot);
        EXPECT_EQ(text, layout->numbers[i].text);
        char* end = nullptr;
        const double value = std::strtod(text.c_str(), &end);
        EXPECT_EQ(*end, '\0') << text;
        // Four digits; and where its tick stands, within a dot of the bar.
        const double share = static_cast<double>(i) / static_cast<double>(layout->numbers.size() - 1);
        EXPECT_NEAR(value, range.lo + share * range.width(), 6e-4 * range.magnitude()) << text;
        const double dot_worth = range.width() * layout->dot / (layout->bar.x1 - layout->bar.x0);
        EXPECT_NEAR(value_in_bar(legend, *layout, layout->ticks[i]), value, 1.5 * dot_worth + 6e-4 * range.magnitude());
        EXPECT_GT(pixel(film, layout->ticks[i], layout->bar.y1).r, 0.9f);
        if (i > 0) {
          const LegendText& left = layout->numbers[i - 1];
          EXPECT_GE(layout->numbers[i].x, left.x + (text_width(left.text) + kGlyphAdvance) * layout->dot)
              << text << " touches " << left.text;
        }
      }
      EXPECT_EQ(text_in(film, layout->title, layout->dot), "gauss?curvature");  // a blank has no dots
    }
  EXPECT_GE(numbers, 60);
}

TEST(Legend, TheBarHasTheColoursOfTheScaleAndNothingOutsideThePanelChanges) {
  for (const Range range : {Range{-0.02, 0.02}, Range{0.5, 3}, Range{-1, 4}}) {
    const Legend legend{"mean curvature 1/mm", {range}};
    const ImageSize size{640, 480};
    Film film = grey_film(size);
    ASSERT_TRUE(draw_legend(legend, film));
    const LegendLayout layout = *layout_of(legend, size);
    for (int x = layout.bar.x0; x < layout.bar.x1; ++x) {
      const Colour expected = legend.scale.colour(value_in_bar(legend, layout, x));
      for (int y = layout.bar.y0; y < layout.bar.y1; ++y) ASSERT_EQ(pixel(film, x, y), glm::vec4(expected, 1.0f)) << x << " " << y;
    }
    EXPECT_NEAR(value_in_bar(legend, layout, layout.bar.x0), range.lo, range.width() / 300);
    EXPECT_NEAR(value_in_bar(legend, layout, layout.bar.x1 - 1), range.hi, range.width() / 300);
    int changed_outside = 0, in_panel = 0;
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x) {
        const bool inside = x >= layout.panel.x0 && x < layout.panel.x1 && y >= layout.panel.y0 && y < layout.panel.y1;
        in_panel += inside;
        changed_outside += !inside && pixel(film, x, y) != glm::vec4(0.4f, 0.4f, 0.4f, 1.0f);
      }
    EXPECT_EQ(changed_outside, 0);
    EXPECT_LT(in_panel, size.width * size.height / 8);
  }
}

TEST(Legend, IsLeftOutWhereThereIsNoRoom) {
  int left_out = 0;
  for (const ImageSize size : {ImageSize{64, 48}, ImageSize{1, 1}, ImageSize{640, 20}, ImageSize{30, 900}}) {
    Film film = grey_film(size);
    const auto before = film.rgba;
    EXPECT_FALSE(draw_legend({"mean curvature", {}}, film));
    EXPECT_EQ(film.rgba, before);
    ++left_out;
  }
  EXPECT_EQ(left_out, 4);
}

TEST(BitmapFont, CharactersDifferAndHoldAllThatLegendsWrite) {
  std::set<std::string> pictures;
  for (const char c : font_characters()) {
    std::string dots;
    for (int row = 0; row < kGlyphHeight; ++row)
      for (int column = 0; column < kGlyphWidth; ++column) dots += glyph_dot(c, column, row) ? '#' : '.';
    EXPECT_NE(dots.find('#'), dots.npos) << c;
    pictures.insert(dots);
  }
  EXPECT_EQ(pictures.size(), font_characters().size());
  for (const char c : std::string("0123456789+-.e/^meancurvaturegaussmcmmmuminft"))
    EXPECT_NE(font_characters().find(c), std::string_view::npos) << c;
}

TEST(ColourScale, DivergesAboutZeroOrRunsFromDarkToLight) {
  const ColourScale even{{-2, 2}}, uneven{{-1, 4}}, positive{{1, 3}};
  for (const ColourScale& scale : {even, uneven}) {
    const Colour white = scale.colour(0);
    EXPECT_GT(std::min({white.r, white.g, white.b}), 0.9f);
    EXPECT_GT(scale.colour(scale.range.hi).r, 3 * scale.colour(scale.range.hi).b);
    EXPECT_GT(scale.colour(scale.range.lo).b, 1.1f * scale.colour(scale.range.lo).r);
  }
  EXPECT_EQ(even.colour(9), even.colour(2));
  EXPECT_EQ(even.colour(-kInf), even.colour(-2));
  EXPECT_EQ(uneven.colour(-7), uneven.colour(-1));
  const ColourScale wider{{-4, 4}};
  EXPECT_EQ(uneven.colour(1), wider.colour(1));  // the same rate to both sides
  float last = 0;
  for (int i = 0; i <= 20; ++i) {
    const Colour c = positive.colour(1 + 0.1 * i);
    const float light = 0.2126f * c.r + 0.7152f * c.g + 0.0722f * c.b;
    EXPECT_GT(light, last);
    last = light;
  }
  const Colour undefined = even.colour(std::nan(""));
  EXPECT_GT(undefined.r, 0.9f);
  EXPECT_LT(undefined.b, 0.1f);
}

TEST(ColourScale, RangesEndAtOneTwoOrFive) {
  EXPECT_DOUBLE_EQ(round_up(0.93), 1);
  EXPECT_DOUBLE_EQ(round_up(1), 1);
  EXPECT_DOUBLE_EQ(round_up(1.01), 2);
  EXPECT_DOUBLE_EQ(round_up(0.0021), 0.005);
  EXPECT_DOUBLE_EQ(round_up(5e-7), 5e-7);
  EXPECT_DOUBLE_EQ(round_up(5.1e20), 1e21);
}

// The program draws it, and leaves it out when told to.
TEST(Legend, NoLegendChangesThePanelOnly) {
  const TemporaryDir dir;
  const auto picture = [&](const std::vector<std::string>& more) {
    const std::string path = dir.path() / "picture.exr";
    std::vector<std::string> arguments{"render",
                                       data("patches/teapot.bpt"),
                                       "-o",
                                       path,
                                       "--shade",
                                       "mean-curvature",
                                       "--range=-2,2",
                                       "--samples",
                                       "1",
                                       "--aov",
                                       "none",
                                       "--size",
                                       "320x240",
                                       "-q"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ChildResult result = run_isophote(arguments);
    EXPECT_EQ(result.code, 0) << result.summary();
    auto image = read_image(path);
    EXPECT_TRUE(image);
    return std::move(*image);
  };
  const Image with = picture({}), without = picture({"--no-legend"});
  const LegendLayout layout = *layout_of({"mean curvature", {{-2, 2}}}, {320, 240});
  int changed = 0;
  for (int y = 0; y < 240; ++y)
    for (int x = 0; x < 320; ++x) {
      const auto i = static_cast<std::size_t>(y) * 320 + static_cast<std::size_t>(x);
      const bool inside = x >= layout.panel.x0 && x < layout.panel.x1 && y >= layout.panel.y0 && y < layout.panel.y1;
      changed += with.rgba[i] != without.rgba[i];
      if (!inside) {
        ASSERT_EQ(with.rgba[i], without.rgba[i]) << x << " " << y;
      }
    }
  EXPECT_GT(changed, (layout.panel.x1 - layout.panel.x0) * (layout.panel.y1 - layout.panel.y0) * 9 / 10);
}

}  // namespace
}  // namespace iso::test
