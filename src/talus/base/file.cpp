#include "talus/base/file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <stdexcept>

#include "talus/base/error.hpp"

namespace talus {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void refuse_to_write(const fs::path& file) {
  throw std::runtime_error(fmt::format("{} cannot be written: {}", file.string(), std::strerror(errno)));
}

}  // namespace

std::string contents_of(const fs::path& file, std::size_t most) {
  std::ifstream in(file, std::ios::binary);
  std::string text;
  char piece[1 << 16];
  while (in && text.size() <= most) {
    in.read(piece, sizeof piece);
    text.append(piece, std::size_t(in.gcount()));
  }
  if (!in.eof() && text.size() <= most) throw std::runtime_error(fmt::format("{} cannot be read", file.string()));
  if (text.size() > most) throw std::runtime_error(fmt::format("{} holds more than {} bytes", file.string(), most));
  return text;
}

void expect_file(const fs::path& file, std::uintmax_t most) {
  std::error_code failure;
  if (!fs::is_regular_file(file, failure)) throw std::runtime_error(fmt::format("{} cannot be read", file.string()));
  const std::uintmax_t size = fs::file_size(file, failure);
  if (failure) throw std::runtime_error(fmt::format("{} cannot be read", file.string()));
  if (size > most)
    throw std::runtime_error(fmt::format("{} holds {} bytes; at most {} are read", file.string(), size, most));
}

WholeFile::WholeFile(fs::path file) : file_(std::move(file)), unfinished_(file_) {
  unfinished_ += ".unfinished";
  descriptor_ = ::open(unfinished_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor_ < 0) fail();
}

WholeFile::~WholeFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  std::error_code ignored;
  fs::remove(unfinished_, ignored);
}

void WholeFile::fail() const { refuse_to_write(file_); }

void WholeFile::write(const void* bytes, std::size_t n) {
  for (const char* p = static_cast<const char*>(bytes); n > 0;) {
    const ssize_t written = ::write(descriptor_, p, n);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail();
    p += written;
    n -= std::size_t(written);
  }
}

void WholeFile::reserve(std::uintmax_t size) {
  if (::fallocate(descriptor_, 0, 0, off_t(size)) != 0 && errno != EOPNOTSUPP && errno != ENOSYS) fail();
}

void WholeFile::cut_to(std::uintmax_t size) {
  if (::ftruncate(descriptor_, off_t(size)) != 0) fail();
}

void WholeFile::write_at_start(const void* bytes, std::size_t n) {
  if (::pwrite(descriptor_, bytes, n, 0) != ssize_t(n)) fail();
}

void WholeFile::finish() {
  const int descriptor = descriptor_;
  descriptor_ = -1;
  if (::close(descriptor) != 0 || std::rename(unfinished_.c_str(), file_.c_str()) != 0) fail();
}

void WholeFile::finish_on_disk() {
  if (::fsync(descriptor_) != 0) fail();
  finish();
  put_on_disk(file_.has_parent_path() ? file_.parent_path() : fs::path("."));
}

void write_whole(const fs::path& file, std::string_view text) {
  WholeFile whole(file);
  whole.write(text.data(), text.size());
  whole.finish();
}

void put_on_disk(const fs::path& file) {
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) refuse_to_write(file);
  const int failed = ::fsync(descriptor);
  const int why = errno;
  ::close(descriptor);
  errno = why;
  if (failed != 0 && why != EINVAL) refuse_to_write(file);  // EINVAL: the file system has nothing to synchronise
}

FolderLock::FolderLock(const fs::path& folder) : descriptor_(::open(folder.c_str(), O_RDONLY | O_CLOEXEC)) {
  // File systems without locks: continue without a lock.
  if (descriptor_ >= 0 && ::flock(descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    ::close(descriptor_);
    throw InputError(fmt::format("another run is writing into {}", folder.string()));
  }
}

FolderLock::~FolderLock() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

}  // namespace talus
