#pragma once
/// Files that are written whole or not at all.

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <string_view>

namespace talus {

/// What a file holds. Throws std::runtime_error if it cannot be read, or holds more than `most` bytes; then no more than
/// these were read.
std::string contents_of(const std::filesystem::path& file, std::size_t most = std::numeric_limits<std::size_t>::max());

/// Throws std::runtime_error unless this is a file, and no pipe, device or folder, of at most `most` bytes. For files
/// that an input names.
void expect_file(const std::filesystem::path& file, std::uintmax_t most);

/// A file that is called NAME.unfinished until it is whole. All functions throw std::runtime_error, with the file and
/// the system's reason, where something cannot be written.
class WholeFile {
 public:
  explicit WholeFile(std::filesystem::path file);
  /// Removes what was not finished.
  ~WholeFile();
  WholeFile(const WholeFile&) = delete;
  WholeFile& operator=(const WholeFile&) = delete;

  void write(const void* bytes, std::size_t n);
  /// The name that it has now, for a library that writes it itself.
  const std::filesystem::path& unfinished() const { return unfinished_; }
  /// Makes room on the disk for so many bytes, as far as the file system does that, so that writing them cannot fail.
  void reserve(std::uintmax_t size);
  void cut_to(std::uintmax_t size);
  void write_at_start(const void* bytes, std::size_t n);
  /// Gives the file its name, in place of an older one.
  void finish();
  /// The same once all of it is on the disk, so that it outlasts a power cut.
  void finish_on_disk();

 private:
  [[noreturn]] void fail() const;

  std::filesystem::path file_, unfinished_;
  int descriptor_;
};

/// Writes a text as a whole file.
void write_whole(const std::filesystem::path& file, std::string_view text);

/// Waits until a file is on the disk.
void put_on_disk(const std::filesystem::path& file);

/// Keeps other runs out of a folder while it lives.
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
