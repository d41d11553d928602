#include "talus/output/snapshot.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <zlib.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <optional>
#include <stdexcept>

#include "talus/base/file.hpp"
#include "talus/output/hdf5.hpp"

namespace talus {

using hdf5::check, hdf5::Handle, hdf5::read_text_attribute, hdf5::write_text_attribute;

namespace {

constexpr hsize_t rows_of_chunk = 65536;
constexpr int fastest = 1;  // level of zlib

/// Whether so many rows are stored in chunks, and packed.
bool in_chunks(std::size_t n_rows) { return n_rows > 1000; }

/// Makes a dataset without values.
Handle make_dataset(hid_t group, const char* name, hid_t stored, std::size_t n, int components) {
  const hsize_t dims[2] = {n, hsize_t(components)};
  const Handle space(H5Screate_simple(components > 1 ? 2 : 1, dims, nullptr), H5Sclose, "make a space");
  const Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "make properties");
  if (in_chunks(n)) {
    const hsize_t chunk[2] = {std::min(dims[0], rows_of_chunk), hsize_t(components)};
    H5Pset_chunk(properties, components > 1 ? 2 : 1, chunk);
    H5Pset_shuffle(properties);
    H5Pset_deflate(properties, fastest);
  }
  H5Pset_fill_time(properties, H5D_FILL_TIME_NEVER);  // all values are written
  H5Pset_obj_track_times(properties, false);          // the same numbers make the same file
  return Handle(H5Dcreate2(group, name, stored, space, H5P_DEFAULT, properties, H5P_DEFAULT), H5Dclose,
                "make a dataset");
}

template <class T>
void write_dataset(hid_t group, const char* name, hid_t stored, hid_t in_memory, const std::vector<T>& values) {
  const Handle set = make_dataset(group, name, stored, values.size(), 1);
  if (!values.empty()) check(H5Dwrite(set, in_memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), "write a dataset");
}

/// Writes `n` numbers in pieces: value(i) for each i.
template <class T, class Value>
void write_numbers(hid_t group, const char* name, hid_t stored, hid_t in_memory, std::size_t n, Value value) {
  const Handle set = make_dataset(group, name, stored, n, 1);
  const Handle space(H5Dget_space(set), H5Sclose, "find a space");
  std::vector<T> values;
  for (hsize_t first = 0; first < n; first += values.size()) {
    values.resize(std::size_t(std::min(rows_of_chunk, n - first)));
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = value(first + i);
    const hsize_t size = values.size();
    const Handle piece(H5Screate_simple(1, &size, nullptr), H5Sclose, "make a space");
    check(H5Sselect_hyperslab(space, H5S_SELECT_SET, &first, nullptr, &size, nullptr), "select a piece");
    check(H5Dwrite(set, in_memory, piece, space, H5P_DEFAULT, values.data()), "write a dataset");
  }
}

/// A chunk as the filters of `make_dataset` leave it. Numbers of particles hardly repeat. To look for what does, as HDF5
/// would, takes zlib 1.8 times as long as to look for runs of equal bytes, and makes 4 % less.
std::vector<Bytef> packed_chunk(const std::vector<Bytef>& chunk, std::size_t size_of_number) {
  const std::size_t n = chunk.size() / size_of_number;
  std::vector<Bytef> shuffled(chunk.size());
  for (std::size_t byte = 0; byte < size_of_number; ++byte)
    for (std::size_t i = 0; i < n; ++i) shuffled[byte * n + i] = chunk[i * size_of_number + byte];
  z_stream stream{};
  constexpr int window_bits = 15, memory_level = 8;  // those of zlib's compress
  if (deflateInit2(&stream, fastest, Z_DEFLATED, window_bits, memory_level, Z_RLE) != Z_OK) throw std::bad_alloc();
  std::vector<Bytef> bytes(deflateBound(&stream, shuffled.size()));
  stream.next_in = shuffled.data();
  stream.avail_in = uInt(shuffled.size());
  stream.next_out = bytes.data();
  stream.avail_out = uInt(bytes.size());
  deflate(&stream, Z_FINISH);  // ends, as there is room for all of it
  bytes.resize(stream.total_out);
  deflateEnd(&stream);
  return bytes;
}

/// Writes a field into its dataset.
void write_field(hid_t set, const Field& field) {
  const std::size_t columns = std::size_t(field.components), n_rows = field.values.size() / columns;
  if (!in_chunks(n_rows)) {
    if (n_rows > 0)
      check(H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, field.values.data()), "write a dataset");
    return;
  }
  const Handle stored(H5Dget_type(set), H5Tclose, "find a type");
  const std::size_t size = H5Tget_size(stored), rows_in_each = std::min(n_rows, std::size_t(rows_of_chunk));
  for (std::size_t first = 0; first < n_rows; first += rows_in_each) {
    const std::size_t n = columns * std::min(rows_in_each, n_rows - first);
    std::vector<Bytef> chunk(n * sizeof(double));
    std::memcpy(chunk.data(), field.values.data() + columns * first, chunk.size());
    check(H5Tconvert(H5T_NATIVE_DOUBLE, stored, n, chunk.data(), nullptr, H5P_DEFAULT), "convert numbers");
    chunk.resize(n * size);
    chunk.resize(columns * rows_in_each * size);  // the last chunk is as long as the others
    const std::vector<Bytef> bytes = packed_chunk(chunk, size);
    const hsize_t offset[2] = {first, 0};
    check(H5Dwrite_chunk(set, H5P_DEFAULT, 0, offset, bytes.size(), bytes.data()), "write a dataset");
  }
}

/// The fields of a snapshot: where they are in the file, and as which type.
template <class F>
void for_each_dataset(const Observation& seen, const std::vector<std::string>& names, F f) {
  f("VTKHDF", "Points", H5T_IEEE_F64LE, seen.fields.at(0));
  for (const std::string& name : names)
    if (const Field* field = seen.find(name))
      f("VTKHDF/PointData", name, name == "id" || name == "ancestor" ? H5T_STD_I64LE : H5T_IEEE_F32LE, *field);
}

/// Writes all of a snapshot of `n` particles but the values of its fields.
void write_frame(hid_t file, const Observation& seen, std::size_t n, const std::vector<std::string>& names) {
  const Handle root(H5Gcreate2(file, "VTKHDF", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose, "make a group");
  {
    const hsize_t two = 2;
    const Handle space(H5Screate_simple(1, &two, nullptr), H5Sclose, "make a space");
    const Handle version(H5Acreate2(root, "Version", H5T_STD_I64LE, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                         "make an attribute");
    const long long one_zero[2] = {1, 0};
    check(H5Awrite(version, H5T_NATIVE_LLONG, one_zero), "write an attribute");
  }
  write_text_attribute(root, "Type", "UnstructuredGrid");
  for (const char* count : {"NumberOfPoints", "NumberOfCells", "NumberOfConnectivityIds"})
    write_dataset(root, count, H5T_STD_I64LE, H5T_NATIVE_LLONG, std::vector<long long>{(long long)n});
  const auto number = [](hsize_t i) { return (long long)i; };
  write_numbers<long long>(root, "Offsets", H5T_STD_I64LE, H5T_NATIVE_LLONG, n + 1, number);
  write_numbers<long long>(root, "Connectivity", H5T_STD_I64LE, H5T_NATIVE_LLONG, n, number);
  constexpr unsigned char vertex = 1;  // VTK_VERTEX
  write_numbers<unsigned char>(root, "Types", H5T_STD_U8LE, H5T_NATIVE_UCHAR, n, [](hsize_t) { return vertex; });
  const Handle data(H5Gcreate2(root, "PointData", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose, "make a group");
  for_each_dataset(seen, names, [&](const char* group, const std::string& name, hid_t stored, const Field& field) {
    const Handle in(H5Gopen2(file, group, H5P_DEFAULT), H5Gclose, "find a group");
    const Handle set = make_dataset(in, name.c_str(), stored, n, field.components);
    write_text_attribute(set, "units", field.unit);
    write_text_attribute(set, "meaning", field.meaning);
  });
  const Handle run(H5Gcreate2(file, "talus", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose, "make a group");
  write_dataset(run, "time", H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, std::vector<double>{seen.time});
  write_dataset(run, "step", H5T_STD_I64LE, H5T_NATIVE_LLONG, std::vector<long long>{seen.step});
}

/// The bytes of the file. It is made in memory: once HDF5 has failed to write to a disk, it crashes when the program
/// ends.
std::string file_of(const Observation& seen, const std::vector<std::string>& names) {
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "make properties");
  constexpr std::size_t growth = 1 << 20;
  check(H5Pset_fapl_core(access, growth, false), "keep a file in memory");
  const Handle file(H5Fcreate("in memory", H5F_ACC_TRUNC, H5P_DEFAULT, access), H5Fclose, "create the file");
  write_frame(file, seen, std::size_t(seen.n_particles()), names);
  for_each_dataset(seen, names, [&](const char* group, const std::string& name, hid_t, const Field& field) {
    const Handle in(H5Gopen2(file, group, H5P_DEFAULT), H5Gclose, "find a group");
    const Handle set(H5Dopen2(in, name.c_str(), H5P_DEFAULT), H5Dclose, "find a dataset");
    write_field(set, field);
  });
  check(H5Fflush(file, H5F_SCOPE_GLOBAL), "flush the file");
  const ssize_t size = H5Fget_file_image(file, nullptr, 0);
  std::string bytes(std::size_t(std::max<ssize_t>(size, 0)), ' ');
  check(H5Fget_file_image(file, bytes.data(), bytes.size()) > 0 ? 0 : -1, "hand out the file");
  return bytes;
}

/// The first of every `every` rows. They are read in pieces of all rows: to select single ones takes HDF5 ten times as long.
template <class T>
std::vector<T> read_values(hid_t set, hid_t wanted, std::size_t every = 1) {
  const Handle space(H5Dget_space(set), H5Sclose, "read a dataset");
  hsize_t size[H5S_MAX_RANK] = {0, 1};
  const int rank = H5Sget_simple_extent_dims(space, size, nullptr);
  check(rank == 1 || rank == 2 ? 0 : -1, "read a dataset");
  const std::size_t n_rows = size[0], columns = size[1];
  std::vector<T> values, piece;
  values.reserve((n_rows + every - 1) / every * columns);
  for (std::size_t begin = 0, end; begin < n_rows; begin = end) {
    end = std::min(n_rows, begin + std::size_t(rows_of_chunk));
    const hsize_t first[2] = {begin, 0}, of_piece[2] = {end - begin, columns};
    piece.resize((end - begin) * columns);
    const Handle rows(H5Screate_simple(rank, of_piece, nullptr), H5Sclose, "make a space");
    check(H5Sselect_hyperslab(space, H5S_SELECT_SET, first, nullptr, of_piece, nullptr), "select rows");
    check(H5Dread(set, wanted, rows, space, H5P_DEFAULT, piece.data()), "read a dataset");
    for (std::size_t row = (begin + every - 1) / every * every; row < end; row += every) {
      const auto values_of_row = piece.begin() + std::ptrdiff_t((row - begin) * columns);
      values.insert(values.end(), values_of_row, values_of_row + std::ptrdiff_t(columns));
    }
  }
  return values;
}

Field read_field(hid_t group, const std::string& name, std::size_t every) {
  const Handle set(H5Dopen2(group, name.c_str(), H5P_DEFAULT), H5Dclose, "find a dataset");
  const Handle space(H5Dget_space(set), H5Sclose, "read a dataset");
  hsize_t dims[H5S_MAX_RANK] = {0, 1};
  const int rank = H5Sget_simple_extent_dims(space, dims, nullptr);
  return {name, read_text_attribute(set, "units"), read_text_attribute(set, "meaning"), rank == 2 ? int(dims[1]) : 1,
          read_values<double>(set, H5T_NATIVE_DOUBLE, every)};
}

Observation read_file(const std::filesystem::path& path, std::size_t every) {
  const Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose, "open the file");
  const Handle root(H5Gopen2(file, "VTKHDF", H5P_DEFAULT), H5Gclose, "find its points");
  const Handle data(H5Gopen2(root, "PointData", H5P_DEFAULT), H5Gclose, "find its fields");
  const Handle run(H5Gopen2(file, "talus", H5P_DEFAULT), H5Gclose, "find its time");
  const Handle time(H5Dopen2(run, "time", H5P_DEFAULT), H5Dclose, "find its time");
  const Handle step(H5Dopen2(run, "step", H5P_DEFAULT), H5Dclose, "find its step");
  Observation seen{read_values<double>(time, H5T_NATIVE_DOUBLE).at(0),
                   read_values<long>(step, H5T_NATIVE_LONG).at(0),
                   {read_field(root, "Points", every)}};
  seen.fields[0].name = "position";
  H5G_info_t all;
  check(H5Gget_info(data, &all), "count its fields");
  for (hsize_t i = 0; i < all.nlinks; ++i) {
    const auto name = [&](char* text, std::size_t size) {
      return H5Lget_name_by_idx(data, ".", H5_INDEX_NAME, H5_ITER_INC, i, text, size, H5P_DEFAULT);
    };
    std::string text(std::size_t(std::max<ssize_t>(0, name(nullptr, 0))), ' ');
    check(name(text.data(), text.size() + 1) < 0 ? -1 : 0, "name a field");
    seen.fields.push_back(read_field(data, text, every));
  }
  return seen;
}

}  // namespace

std::size_t particles_in(const std::filesystem::path& snapshot) {
  hdf5::begin();
  try {
    const Handle file(H5Fopen(snapshot.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose, "open the file");
    const Handle count(H5Dopen2(file, "VTKHDF/NumberOfPoints", H5P_DEFAULT), H5Dclose, "find its points");
    return std::size_t(read_values<long>(count, H5T_NATIVE_LONG).at(0));
  } catch (const std::exception& e) {
    throw std::runtime_error(fmt::format("the snapshot {} could not be read: {}", snapshot.string(), e.what()));
  }
}

Observation read_snapshot(const std::filesystem::path& file, std::size_t every) {
  hdf5::begin();
  try {
    return read_file(file, every);
  } catch (const std::exception& e) {
    throw std::runtime_error(fmt::format("the snapshot {} could not be read: {}", file.string(), e.what()));
  }
}

std::vector<std::filesystem::path> read_series(const std::filesystem::path& series_file) {
  std::vector<std::filesystem::path> files;
  try {
    std::ifstream in(series_file);
    const nlohmann::json series = nlohmann::json::parse(in);
    for (const auto& listed : series.at("files"))
      files.push_back(series_file.parent_path() / listed.at("name").get<std::string>());
  } catch (const std::exception& e) {
    throw std::runtime_error(fmt::format("the series {} could not be read: {}", series_file.string(), e.what()));
  }
  return files;
}

void write_snapshot(const std::filesystem::path& file, const Observation& seen,
                    const std::vector<std::string>& fields) {
  hdf5::begin();
  write_whole(file, file_of(seen, fields));
}

UnfilledSnapshot::UnfilledSnapshot(const std::filesystem::path& file, const ObservedPart& part,
                                   const std::vector<std::string>& fields)
    : whole_(file) {
  hdf5::begin();
  // HDF5 says neither which file it cannot write nor why; so there is room before it writes.
  constexpr std::size_t for_frame = 1 << 20, of_particle = 2 * sizeof(long long) + 1;
  std::size_t bytes = for_frame + part.n_all * of_particle;
  for_each_dataset(part.seen, fields, [&](const char*, const std::string&, hid_t stored, const Field& field) {
    bytes += part.n_all * std::size_t(field.components) * H5Tget_size(stored);
  });
  std::optional<Handle> made;
  hdf5::write_part_of(file, [&] {
    made.emplace(H5Fcreate(whole_.unfinished().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose,
                 "create the file");
  });
  whole_.reserve(bytes);
  hdf5::write_part_of(file, [&] {
    write_frame(*made, part.seen, part.n_all, fields);
    check(H5Fflush(*made, H5F_SCOPE_GLOBAL), "write the file");
  });
  made.reset();
  whole_.reserve(bytes);  // closing the file has cut it
}

void fill_snapshot(const ObservedPart& part, const std::vector<std::string>& fields, const WriteRows& write) {
  for_each_dataset(part.seen, fields, [&](const char* group, const std::string& name, hid_t, const Field& field) {
    write(std::string(group) + "/" + name, part.first, field.components, field.values);
  });
}

SnapshotSeries::SnapshotSeries(std::filesystem::path folder, std::vector<std::string> fields, std::vector<double> times)
    : folder_(std::move(folder)), fields_(std::move(fields)), times_(std::move(times)) {
  std::vector<std::filesystem::path> later;
  for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
    const std::string name = entry.path().filename();
    int number;
    if (std::sscanf(name.c_str(), "particles_%d", &number) != 1 || number < size()) continue;
    const std::string own = file(number).filename();
    if (name == own || name == own + ".unfinished") later.push_back(entry.path());
  }
  for (const auto& path : later) std::filesystem::remove(path);
  if (times_.empty())
    std::filesystem::remove(series_file());
  else
    write_whole(series_file(), list());
}

std::filesystem::path SnapshotSeries::file(int number) const {
  return folder_ / fmt::format("particles_{:04d}.hdf", number);
}

std::string SnapshotSeries::list() const {
  nlohmann::json series;
  series["file-series-version"] = "1.0";
  for (int i = 0; i < size(); ++i)
    series["files"].push_back({{"name", file(i).filename().string()}, {"time", times_[i]}});
  return series.dump(1) + "\n";
}

void SnapshotSeries::add(Observation seen) {
  finish();
  times_.push_back(seen.time);
  writing_ = std::async(std::launch::async, [file = last(), seen = std::move(seen), fields = fields_,
                                             series = series_file(), text = list()] {
    write_snapshot(file, seen, fields);
    write_whole(series, text);
  });
}

void SnapshotSeries::add(double time, const std::function<void(const std::filesystem::path&)>& write) {
  finish();
  times_.push_back(time);
  write(last());
  write_whole(series_file(), list());
}

}  // namespace talus
