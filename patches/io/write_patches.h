// Writes n-sided patches as an .ipatch file (patches/io/ipatch.schema.json). Every double is written with the fewest digits that mean it,
// so reading gives the same bits back; so are the floats of colours.
#pragma once

#include <string>

#include "patches/io/patch_set.h"

namespace iso {

// What `parse_ipatch` reads back. Members that say nothing (weights all one, no corners, ...) are left out; problems are not written.
std::string ipatch_text(const PatchSet& set);

// The file appears whole or not at all.
Status write_patches(const std::string& path, const PatchSet& set);

}  // namespace iso
