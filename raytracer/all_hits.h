// The hits of one ray put in order, each once.
#pragma once

#include <vector>

#include "raytracer/tracer.h"

namespace iso {

// Sorted hits of one ray, without the doubles that overlapping leaves, seams and edge tolerances make: the same face met in the same point
// in the same sense, or two faces at one loose edge.
// `size`: diagonal of the scene.
void sort_and_remove_doubles(const Tracer& tracer, const Ray& ray, double size, std::vector<Hit>& hits);

}  // namespace iso
