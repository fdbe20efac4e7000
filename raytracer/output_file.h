// Files that appear whole or not at all: written under another name in the same folder, then renamed.
#pragma once

#include <string>
#include <string_view>

#include "patches/base/result.h"

namespace iso {

// Whether `path` could be written: folder present and writable, not a folder itself. Leaves nothing behind. Asked before long work.
Status check_writable(const std::string& path);

// Writes all bytes, forces them to disk and renames; on failure the old file, if any, stays as it was. Devices and pipes are written
// directly.
Status write_whole_file(const std::string& path, std::string_view bytes);

}  // namespace iso
