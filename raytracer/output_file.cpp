#include "raytracer/output_file.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <optional>

namespace iso {
namespace {

Error failed(const std::string& path, const char* doing) {
  return read_write_error(path, fmt::format("{}: {}", doing, std::strerror(errno)));
}

// Something other than a regular file under this name, such as /dev/null: it is written into, never replaced.
bool is_special(const std::string& path) {
  struct stat info {};
  return ::stat(path.c_str(), &info) == 0 && !S_ISREG(info.st_mode) && !S_ISDIR(info.st_mode);
}

// An open temporary file beside the final one; removed again unless it was renamed.
class Temporary {
 public:
  explicit Temporary(const std::string& final_path) : name_(final_path + ".partXXXXXX"), fd_(::mkstemp(name_.data())) {}
  Temporary(const Temporary&) = delete;
  Temporary& operator=(const Temporary&) = delete;
  ~Temporary() {
    if (fd_ >= 0) ::close(fd_);
    if (made_ && !renamed_) ::unlink(name_.c_str());
  }

  bool open() const { return fd_ >= 0; }
  int fd() const { return fd_; }
  bool close() { return ::close(std::exchange(fd_, -1)) == 0; }
  bool rename_to(const std::string& path) {
    renamed_ = ::rename(name_.c_str(), path.c_str()) == 0;
    return renamed_;
  }

 private:
  std::string name_;
  int fd_;
  bool made_ = fd_ >= 0;
  bool renamed_ = false;
};

bool write_all(int fd, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(fd, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
  return true;
}

Status write_special(const std::string& path, std::string_view bytes) {
  const int fd = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
  if (fd < 0) return failed(path, "cannot be opened for writing");
  const bool written = write_all(fd, bytes);
  const int write_errno = errno;
  const bool closed = ::close(fd) == 0;
  if (!written) errno = write_errno;
  if (!written || !closed) return failed(path, "writing failed");
  return Done{};
}

// The reasons that can be told without making a file.
std::optional<Error> refusal(const std::string& path) {
  if (path.empty()) return read_write_error({}, "the name of the output file is empty");
  struct stat info {};
  if (::stat(path.c_str(), &info) != 0) return {};
  if (S_ISDIR(info.st_mode)) return read_write_error(path, "is a folder; expected the name of a file");
  if (::access(path.c_str(), W_OK) != 0) return failed(path, "exists and may not be written");
  return {};
}

}  // namespace

Status check_writable(const std::string& path) {
  if (auto error = refusal(path)) return *error;
  if (is_special(path)) return Done{};
  if (!Temporary(path).open()) return failed(path, "cannot be created");
  return Done{};
}

Status write_whole_file(const std::string& path, std::string_view bytes) {
  if (auto error = refusal(path)) return *error;
  if (is_special(path)) return write_special(path, bytes);
  Temporary file(path);
  if (!file.open()) return failed(path, "cannot be created");

  // mkstemp makes private files; give it the rights a new file would have.
  const mode_t mask = ::umask(0);
  ::umask(mask);
  if (::fchmod(file.fd(), 0666 & ~mask) != 0) return failed(path, "rights cannot be set");
  if (!write_all(file.fd(), bytes) || ::fsync(file.fd()) != 0 || !file.close()) return failed(path, "writing failed");
  if (!file.rename_to(path)) return failed(path, "cannot be put in place");
  return Done{};
}

}  // namespace iso
