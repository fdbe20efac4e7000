// What Open CASCADE does not look at before it trusts a file: words where numbers belong. In STEP a coordinate NaN makes it loop for ever,
// in BREP any word is taken for zero, without a sign of it.
#pragma once

#include <string>
#include <string_view>

#include "patches/base/result.h"

namespace iso {

// Refuses the text of a STEP file (ISO 10303-21) in which a number is no number (NaN, infinity in any spelling) or absurdly large (a
// coordinate beyond 1e30, others beyond 1e120), or an entity is missing or defined twice; with its line.
Status check_step_text(const std::string& path, std::string_view text);

// Refuses the text of a BREP file in which a word is neither a number nor one of the format's own, with its line.
Status check_brep_text(const std::string& path, std::string_view text);

}  // namespace iso
