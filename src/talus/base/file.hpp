#pragma once
/// Files that are written completely or not at all.

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <string_view>

namespace talus {

/// Reads a file. Throws std::runtime_error if it cannot be read or has more than `most` bytes; it reads at most that
/// many.
std::string contents_of(const std::filesystem::path& file, std::size_t most = std::numeric_limits<std::size_t>::max());

/// Throws std::runtime_error unless this is a regular file of at most `most` bytes. For files named in an input.
void expect_file(const std::filesystem::path& file, std::uintmax_t most);

/// A file with the name NAME.unfinished until it is complete. If writing fails, functions throw std::runtime_error with
/// the file and the reason of the system.
class WholeFile {
 public:
  explicit WholeFile(std::filesystem::path file);
  /// Removes the unfinished file.
  ~WholeFile();
  WholeFile(const WholeFile&) = delete;
  WholeFile& operator=(const WholeFile&) = delete;

  void write(const void* bytes, std::size_t n);
  /// The present name, for a library that writes the file itself.
  const std::filesystem::path& unfinished() const { return unfinished_; }
  /// Reserves this many bytes on the disk, if the file system can, so that writing them cannot fail.
  void reserve(std::uintmax_t size);
  void cut_to(std::uintmax_t size);
  void write_at_start(const void* bytes, std::size_t n);
  /// Renames the file to its final name and replaces an older one.
  void finish();
  /// The same after all data are on the disk, so that the file survives a power failure.
  void finish_on_disk();

 private:
  [[noreturn]] void fail() const;

  std::filesystem::path file_, unfinished_;
  int descriptor_;
};

/// Writes a text as a complete file.
void write_whole(const std::filesystem::path& file, std::string_view text);

/// Waits until a file is on the disk.
void put_on_disk(const std::filesystem::path& file);

/// Locks a folder against other runs during its lifetime.
class FolderLock {
 public:
  /// Throws InputError if another run of talus is writing there.
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_;
};

}  // namespace talus
