// The sRGB curve by its definition, between light and code values, both with white at 1.  [IEC 61966-2-1]
#pragma once

#include <cmath>

namespace iso {

inline float linear_from_srgb(float code) { return code <= 0.04045f ? code / 12.92f : std::pow((code + 0.055f) / 1.055f, 2.4f); }
inline float srgb_from_linear(float light) { return light <= 0.0031308f ? 12.92f * light : 1.055f * std::pow(light, 1 / 2.4f) - 0.055f; }

}  // namespace iso
