#include "talus/output/hdf5.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

namespace talus::hdf5 {

namespace {

/// By default HDF5 1.10 keeps 2 MB of a file's metadata, and 1 MB of each dataset in chunks.
constexpr std::size_t memory_of_a_file = std::size_t(8) << 20;

void require_memory_of_a_file() {
  char* volatile room = new char[memory_of_a_file];  // volatile: else the compiler may leave it out
  delete[] room;
}

}  // namespace

void begin() {
  require_memory_of_a_file();
  static const herr_t without_atexit = H5dont_atexit();  // works once, before anything else
  (void)without_atexit;
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

Handle::Handle(hid_t id, herr_t (*close)(hid_t), const char* action) : id_(id), close_(close) {
  if (id < 0) throw std::runtime_error(fmt::format("HDF5 could not {}", action));
}

void check(herr_t status, const char* action) {
  if (status < 0) throw std::runtime_error(fmt::format("HDF5 could not {}", action));
}

namespace {

/// The type of a text; HDF5 has no empty ones.
class TextType : public Handle {
 public:
  explicit TextType(std::size_t length) : Handle(H5Tcopy(H5T_C_S1), H5Tclose, "make a text type") {
    check(H5Tset_size(*this, std::max<std::size_t>(1, length)), "size a text");
  }
};
const char* bytes_of(const std::string& text) { return text.empty() ? " " : text.data(); }
std::string or_empty(std::string text) { return text == " " ? "" : text; }

}  // namespace

void write_text_attribute(hid_t object, const char* name, const std::string& text) {
  const TextType type(text.size());
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose, "make a scalar");
  const Handle attribute(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                         "make an attribute");
  check(H5Awrite(attribute, type, bytes_of(text)), "write an attribute");
}

std::string read_text_attribute(hid_t object, const char* name) {
  const Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose, "find an attribute");
  const Handle type(H5Aget_type(attribute), H5Tclose, "read an attribute");
  std::string text(H5Tget_size(type), ' ');
  check(H5Aread(attribute, type, text.data()), "read an attribute");
  return or_empty(text);
}

void write_text(hid_t group, const char* name, const std::string& text) {
  const TextType type(text.size());
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose, "make a scalar");
  const Handle set(H5Dcreate2(group, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Dclose,
                   "make a dataset");
  check(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes_of(text)), "write a dataset");
}

std::string read_text(hid_t group, const char* name) {
  const Handle set(H5Dopen2(group, name, H5P_DEFAULT), H5Dclose, "find a dataset");
  const Handle type(H5Dget_type(set), H5Tclose, "read a dataset");
  std::string text(H5Tget_size(type), ' ');
  check(H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()), "read a dataset");
  return or_empty(text);
}

}  // namespace talus::hdf5
