#include "patches/files/output_file.h"

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

bool write_all(int fd, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(fd, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n == 0) errno = EIO;
    if (n <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
  return true;
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

// mkstemp makes private files; this gives one the rights a new file would have.
bool give_usual_rights(int fd) {
  const mode_t mask = ::umask(0);
  ::umask(mask);
  return ::fchmod(fd, 0666 & ~mask) == 0;
}

constexpr std::size_t kBuffer = 1 << 20;

}  // namespace

Status check_writable(const std::string& path) {
  if (auto error = refusal(path)) return *error;
  if (is_special(path)) return Done{};
  if (auto file = OutputFile::open(path); !file) return file.error();
  return Done{};
}

Status write_whole_file(const std::string& path, std::string_view bytes) {
  auto file = OutputFile::open(path);
  if (!file) return file.error();
  file->write(bytes);
  return file->put_in_place();
}

Result<OutputFile> OutputFile::open(const std::string& path) {
  if (auto error = refusal(path)) return *error;
  OutputFile file;
  file.path_ = path;
  if (is_special(path)) {
    file.fd_ = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
    if (file.fd_ < 0) return failed(path, "cannot be opened for writing");
    return file;
  }
  std::string name = path + ".partXXXXXX";
  file.fd_ = ::mkstemp(name.data());
  if (file.fd_ < 0) return failed(path, "cannot be created");
  file.temporary_ = std::move(name);
  if (!give_usual_rights(file.fd_)) return failed(path, "rights cannot be set");
  return file;
}

OutputFile::OutputFile(OutputFile&& other) noexcept
    : path_(std::move(other.path_)),
      temporary_(std::exchange(other.temporary_, {})),
      buffer_(std::move(other.buffer_)),
      size_(other.size_),
      fd_(std::exchange(other.fd_, -1)),
      failure_(other.failure_) {}

OutputFile::~OutputFile() {
  if (fd_ >= 0) ::close(fd_);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

void OutputFile::write(std::string_view bytes) {
  size_ += bytes.size();
  if (failure_ != 0) return;
  if (buffer_.size() + bytes.size() > kBuffer) flush();
  if (bytes.size() < kBuffer) {
    buffer_.append(bytes);
  } else if (failure_ == 0 && !write_all(fd_, bytes)) {
    failure_ = errno;
  }
}

void OutputFile::flush() {
  if (failure_ == 0 && !write_all(fd_, buffer_)) failure_ = errno;
  buffer_.clear();
}

Status OutputFile::finish() {
  ISO_CHECK(fd_ >= 0);
  flush();
  if (failure_ == 0 && !temporary_.empty() && ::fsync(fd_) != 0) failure_ = errno;
  if (::close(std::exchange(fd_, -1)) != 0 && failure_ == 0) failure_ = errno;
  errno = failure_;
  if (failure_ != 0) return failed(path_, "writing failed");
  return Done{};
}

Status OutputFile::put_in_place() {
  if (fd_ >= 0)
    if (auto finished = finish(); !finished) return finished.error();
  ISO_CHECK(failure_ == 0);
  if (!temporary_.empty() && ::rename(temporary_.c_str(), path_.c_str()) != 0) return failed(path_, "cannot be put in place");
  temporary_.clear();
  return Done{};
}

}  // namespace iso
