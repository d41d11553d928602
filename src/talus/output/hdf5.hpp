#pragma once
/// Parts of HDF5 files. HDF5 runs on one thread at a time.

#include <hdf5.h>

#include <filesystem>
#include <stdexcept>
#include <string>

namespace talus::hdf5 {

/// To be called before any other function: errors are thrown instead of printed, and files that could not be written are
/// left alone when the program ends, which HDF5 would crash on. Throws std::bad_alloc if there is less memory than HDF5
/// takes for a file, as it crashes where it gets none.
void begin();

/// An HDF5 identifier that closes itself; a negative one is an error.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t), const char* action);
  ~Handle() { close_(id_); }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  operator hid_t() const { return id_; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// Throws std::runtime_error "HDF5 could not ..." if the status is negative.
void check(herr_t status, const char* action);

/// Writes a part of a file by HDF5, which does not name it: what is thrown becomes std::runtime_error "FILE cannot be
/// written: ...".
template <class Write>
void write_part_of(const std::filesystem::path& file, Write write) {
  try {
    write();
  } catch (const std::exception& e) {
    throw std::runtime_error(file.string() + " cannot be written: " + e.what());
  }
}

void write_text_attribute(hid_t object, const char* name, const std::string& text);
std::string read_text_attribute(hid_t object, const char* name);

/// A text of any length as a dataset.
void write_text(hid_t group, const char* name, const std::string& text);
std::string read_text(hid_t group, const char* name);

}  // namespace talus::hdf5
