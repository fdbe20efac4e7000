// The sections of a comparison's page, each an HTML <section> or empty if there is nothing to tell; compare_page.cpp puts them together.
#pragma once

#include "raytracer/cmd/compare_report.h"

namespace iso {

// compare_tables.cpp
std::string mesh_section(const CompareReport& report);      // what was found wrong, and the table of distances, normals and topology
std::string strategy_section(const CompareReport& report);  // strategies beside each other
std::string image_section(const CompareReport& report);     // metrics of pictures
std::string cost_section(const CompareReport& report);
std::string face_section(const CompareReport& report);  // the worst faces of each mesh

// compare_gallery.cpp
std::string picture_section(const CompareReport& report);
std::string chart_section(const CompareReport& report);

// compare_style.cpp
extern const char* const kPageStyle;
extern const char* const kPageScript;

// "mm", or "model units".
std::string unit_text(const CompareReport& report);

}  // namespace iso
