// Files that appear whole or not at all: written under another name in the same folder, then renamed.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include "patches/base/result.h"

namespace iso {

// Whether `path` could be written: folder present and writable, not a folder itself. Leaves nothing behind. Asked before long work.
Status check_writable(const std::string& path);

// Writes all bytes, forces them to disk and renames; on failure the old file, if any, stays as it was. Devices and pipes are written
// directly.
Status write_whole_file(const std::string& path, std::string_view bytes);

// The same for what is too large to be held: pieces are collected and written, `finish` forces them to disk, `put_in_place` renames. If it
// goes out of scope before that, nothing is left and the old file stays. After a failed `write` the rest is dropped; `finish` tells.
class OutputFile {
 public:
  static Result<OutputFile> open(const std::string& path);
  OutputFile(OutputFile&& other) noexcept;
  OutputFile& operator=(OutputFile&&) = delete;
  ~OutputFile();

  void write(std::string_view bytes);
  std::uint64_t size() const { return size_; }  // bytes written so far
  const std::string& path() const { return path_; }
  Status finish();
  Status put_in_place();  // finishes first if that was not done

 private:
  OutputFile() = default;
  void flush();

  std::string path_;
  std::string temporary_;  // its name until it is renamed; empty for devices and pipes
  std::string buffer_;
  std::uint64_t size_ = 0;
  int fd_ = -1;
  int failure_ = 0;  // errno of the first failed write
};

}  // namespace iso
