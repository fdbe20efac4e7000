// The text of --tolerance and what it means in units of a model.
#include "raytracer/tolerance.h"

#include <gtest/gtest.h>

#include <string>

namespace iso {
namespace {

TEST(Tolerance, TextsAreNumbersOfModelUnitsLengthsOrDiagonals) {
  const struct {
    const char *text, *model_unit;
    double diagonal, units;
  } cases[] = {{"0.01", "", 5, 0.01},      {"0.01", "mm", 5, 0.01}, {"1e-4d", "mm", 200, 0.02}, {"1e-4 d", "", 200, 0.02},
               {"0.05mm", "mm", 5, 0.05},  {"50um", "mm", 5, 0.05}, {"0.005cm", "mm", 5, 0.05}, {"1in", "mm", 5, 25.4},
               {"1 ft", "in", 5, 12},      {"2m", "cm", 5, 200},    {"1mm", "m", 5, 0.001},     {"1e-3 mm", "um", 5, 1},
               {"1cm", "ft", 5, 1 / 30.48}};
  int checked = 0;
  for (const auto& c : cases) {
    const auto tolerance = tolerance_named(c.text);
    ASSERT_TRUE(tolerance) << tolerance.error().text();
    const auto units = in_units(*tolerance, c.diagonal, c.model_unit);
    ASSERT_TRUE(units) << units.error().text();
    EXPECT_NEAR(*units, c.units, 1e-12 * c.units) << c.text << " of a model in '" << c.model_unit << "'";
    ++checked;
  }
  EXPECT_EQ(checked, 13);
}

TEST(Tolerance, OtherTextsAreRefusedAndTheErrorSaysWhatWasFoundAndExpected) {
  int refused = 0;
  for (const char* text : {"",       "d",   "mm",     "0",     "0mm", "-1",   "-1e-4d", "nan", "inf", "1e999",
                           "1e-999", "1km", "1 mm x", "1,5mm", "+1",  "0x10", " 1",     "1D",  "1MM", "1d d"}) {
    const auto tolerance = tolerance_named(text);
    ASSERT_FALSE(tolerance) << text;
    EXPECT_EQ(tolerance.error().kind, Exit::bad_command_line);
    const std::string said = tolerance.error().text();
    EXPECT_NE(said.find(std::string("'") + text + "'"), said.npos) << said;
    EXPECT_NE(said.find("expected a positive number with one of m cm mm um in ft, d"), said.npos) << said;
    ++refused;
  }
  EXPECT_EQ(refused, 20);
}

TEST(Tolerance, LengthsNeedAModelWithAUnitAndResultsMustBePositiveNumbers) {
  for (const char* unit : {"", "d", "furlong"}) {
    const auto units = in_units({1, ToleranceUnit::millimetre}, 5, unit);
    ASSERT_FALSE(units) << unit;
    EXPECT_NE(units.error().text().find("found a length in mm"), std::string::npos) << units.error().text();
    EXPECT_NE(units.error().text().find(*unit ? unit : "unknown"), std::string::npos) << units.error().text();
  }
  EXPECT_FALSE(in_units({1e-13, ToleranceUnit::diagonal}, 5, "mm"));
  EXPECT_FALSE(in_units({1e-12, ToleranceUnit::millimetre}, 5, "mm"));
  EXPECT_FALSE(in_units({1e-4, ToleranceUnit::diagonal}, 0, "mm"));
  EXPECT_FALSE(in_units({1e300, ToleranceUnit::diagonal}, 1e300, "mm"));
  EXPECT_FALSE(in_units({1e-300, ToleranceUnit::diagonal}, 1e-300, "mm"));
}

}  // namespace
}  // namespace iso
