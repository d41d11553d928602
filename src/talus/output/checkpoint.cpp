#include "talus/output/checkpoint.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>
#include <zlib.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>

#include "talus/base/error.hpp"
#include "talus/base/file.hpp"
#include "talus/base/machine.hpp"
#include "talus/output/hdf5.hpp"

namespace talus {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Schedule, interval, next, last)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(RunSoFar, case_file, case_text, end, time, step, history_bytes, profile_bytes,
                                   surface_map_bytes, gauge_bytes, snapshots, instants, next_snapshot, next_row,
                                   pressure_noise, maps, forces, profile, gauges, map_checksum, peak_kinetic, last_flow,
                                   wall_seconds, cpu_seconds, resumed_at)

namespace {

namespace fs = std::filesystem;

constexpr std::string_view kind = "talus checkpoint ", format = "10\n";

/// What stands before the HDF5 file in the same file, in what HDF5 calls a user block: what it is, and the checksum of the
/// rest.
constexpr std::size_t block_size = 512;
std::string block_of(std::uint32_t checksum) {
  std::string block =
      fmt::format("{}{}an HDF5 file from byte {} on, with the CRC-32 {:08x}\n", kind, format, block_size, checksum);
  block.resize(block_size, '\n');
  return block;
}

/// Throws std::runtime_error with the reason, unless a file has its block and checksum. Returns the checksum of the rest.
std::uint32_t checksum_after_block(std::ifstream& in) {
  std::vector<char> piece(1 << 20);
  std::uint32_t sum = 0;
  while (in.read(piece.data(), std::streamsize(piece.size())), in.gcount() > 0)
    sum = std::uint32_t(::crc32_z(sum, reinterpret_cast<const unsigned char*>(piece.data()), std::size_t(in.gcount())));
  return sum;
}
void expect_undamaged(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string block(block_size, ' ');
  in.read(block.data(), std::streamsize(block_size));
  block.resize(std::size_t(in.gcount()));
  if (block.substr(0, kind.size()) != kind) throw std::runtime_error("it is no checkpoint of talus");
  if (block.substr(kind.size(), format.size()) != format)
    throw std::runtime_error("it is of another format than this version of talus writes, or damaged");
  if (block != block_of(checksum_after_block(in)))
    throw std::runtime_error("it is damaged: truncated or changed (wrong checksum)");
}

using hdf5::check, hdf5::Handle;

/// Writes a checkpoint.
class Writer {
 public:
  explicit Writer(const fs::path& file) : whole_(file), name_(file) {
    hdf5::begin();
    hdf5::write_part_of(name_, [&] {
      const Handle properties(H5Pcreate(H5P_FILE_CREATE), H5Pclose, "make properties");
      check(H5Pset_userblock(properties, block_size), "begin a file");
      file_.emplace(H5Fcreate(whole_.unfinished().c_str(), H5F_ACC_TRUNC, properties, H5P_DEFAULT), H5Fclose,
                    "create the file");
      state_.emplace(H5Gcreate2(*file_, "state", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose, "make a group");
    });
  }
  void text(const char* name, const std::string& text) {
    make_room_for(text.size());
    hdf5::write_part_of(name_, [&] { hdf5::write_text(*file_, name, text); });
  }
  /// Makes arrays with room for their numbers.
  void make(const std::vector<StateArray>& arrays) {
    std::size_t bytes = 0;
    for (const StateArray& array : arrays) bytes += array.n * sizeof(double) + size_of_header;
    make_room_for(bytes);
    hdf5::write_part_of(name_, [&] {
      const Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "make properties");
      check(H5Pset_alloc_time(properties, H5D_ALLOC_TIME_EARLY), "make properties");
      check(H5Pset_fill_time(properties, H5D_FILL_TIME_NEVER), "make properties");
      for (const StateArray& array : arrays) {
        const hsize_t n = array.n;
        const Handle space(H5Screate_simple(1, &n, nullptr), H5Sclose, "make a space");
        const Handle set(
            H5Dcreate2(*state_, array.name.c_str(), H5T_IEEE_F64LE, space, H5P_DEFAULT, properties, H5P_DEFAULT),
            H5Dclose, "make a dataset");
      }
    });
  }
  /// Fills them, for one process.
  void fill(const std::vector<StateArray>& arrays) {
    for (const StateArray& array : arrays) {
      const std::vector<double> values = array.part();
      if (values.size() != array.n) throw std::logic_error("other processes have a part of " + array.name);
      if (values.empty()) continue;
      hdf5::write_part_of(name_, [&] {
        const Handle set(H5Dopen2(*state_, array.name.c_str(), H5P_DEFAULT), H5Dclose, "find a dataset");
        check(H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), "write a dataset");
      });
    }
  }
  /// Ends what this process writes by HDF5. Returns the name of the file, which has the room that it needs.
  const fs::path& close() {
    hdf5::write_part_of(name_, [&] {
      state_.reset();
      check(H5Fflush(*file_, H5F_SCOPE_GLOBAL), "write the file");
      check(H5Fget_filesize(*file_, &size_), "measure the file");
      file_.reset();
    });
    whole_.reserve(size_);
    return whole_.unfinished();
  }
  void finish() {
    whole_.cut_to(size_);
    std::ifstream in(whole_.unfinished(), std::ios::binary);
    in.seekg(block_size);
    const std::string block = block_of(checksum_after_block(in));
    whole_.write_at_start(block.data(), block.size());
    whole_.finish_on_disk();
  }

 private:
  static constexpr std::size_t size_of_header = 512;  ///< more than an array takes beside its numbers

  /// HDF5 says neither which file it cannot write nor why; so there is room before it writes.
  void make_room_for(std::size_t bytes) {
    constexpr std::size_t for_names = 1 << 13;
    hsize_t size = 0;
    hdf5::write_part_of(name_, [&] { check(H5Fget_filesize(*file_, &size), "measure the file"); });
    whole_.reserve(size + bytes + for_names);
  }

  WholeFile whole_;
  fs::path name_;
  std::optional<Handle> file_, state_;
  hsize_t size_ = 0;
};

/// At most `most` numbers of an array, from `first` on.
std::vector<double> numbers_of(hid_t group, const std::string& name, std::size_t first, std::size_t most) {
  const Handle set(H5Dopen2(group, name.c_str(), H5P_DEFAULT), H5Dclose, "find a dataset");
  const Handle space(H5Dget_space(set), H5Sclose, "read a dataset");
  const auto all = std::size_t(std::max<hssize_t>(0, H5Sget_simple_extent_npoints(space)));
  std::vector<double> numbers(std::min(most, all - std::min(all, first)));
  if (numbers.empty()) return numbers;
  const hsize_t begin = first, n = numbers.size();
  const Handle piece(H5Screate_simple(1, &n, nullptr), H5Sclose, "make a space");
  check(H5Sselect_hyperslab(space, H5S_SELECT_SET, &begin, nullptr, &n, nullptr), "select a piece");
  check(H5Dread(set, H5T_NATIVE_DOUBLE, piece, space, H5P_DEFAULT, numbers.data()), "read a dataset");
  return numbers;
}

/// The arrays of the state in a file.
class StateFile {
 public:
  explicit StateFile(const fs::path& name)
      : name_(name),
        file_(H5Fopen(name.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose, "open the file"),
        group_(H5Gopen2(file_, "state", H5P_DEFAULT), H5Gclose, "find the state") {}
  std::vector<std::string> names() const {
    std::vector<std::string> all;
    check(H5Literate(
              group_, H5_INDEX_NAME, H5_ITER_INC, nullptr,
              [](hid_t, const char* link, const H5L_info_t*, void* names) -> herr_t {
                static_cast<std::vector<std::string>*>(names)->push_back(link);
                return 0;
              },
              &all),
          "list the state");
    return all;
  }
  std::vector<double> read(const std::string& array, std::size_t first, std::size_t most) const {
    if (H5Lexists(group_, array.c_str(), H5P_DEFAULT) <= 0)
      throw std::runtime_error(fmt::format("{} does not hold `{}`", name_.string(), array));
    return numbers_of(group_, array, first, most);
  }

 private:
  fs::path name_;
  Handle file_, group_;
};

SavedRun read(const fs::path& name) {
  expect_undamaged(name);
  hdf5::begin();
  const Handle file(H5Fopen(name.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose, "open the file");
  auto json = nlohmann::json::parse(hdf5::read_text(file, "run"));
  for (const auto& [key, mine] : {std::pair{"version", version()}, std::pair{"build", build()}})
    if (const std::string its = json.at(key); !same_bits(its, mine))
      throw std::runtime_error(
          fmt::format("the run was begun by {} {}, and this is {}: another one may give other bits",
                      key == std::string_view("version") ? "talus" : "the build", its, mine));
  json.at("run")["case_text"] = hdf5::read_text(file, "case");
  SavedRun saved;
  saved.file = name;
  saved.number = json.at("number");
  saved.so_far = json.at("run");
  return saved;
}

/// Differences between two cases that change results: "cell was 2 mm, is 1 mm".
std::vector<std::string> differences(const std::vector<Understood>& before, const std::vector<Understood>& now) {
  // When checkpoints are written changes no result.
  const auto values = [](const std::vector<Understood>& understood) {
    std::map<std::string, std::string> all;
    for (const Understood& u : understood)
      if (u.path.rfind("output.checkpoint", 0) != 0) all[u.path] = u.value;
    return all;
  };
  const auto was = values(before), is = values(now);
  std::vector<std::string> found;
  for (const auto& [path, value] : was) {
    const auto other = is.find(path);
    if (other == is.end())
      found.push_back(fmt::format("{} was {}, is not there", path, value));
    else if (other->second != value)
      found.push_back(fmt::format("{} was {}, is {}", path, value, other->second));
  }
  for (const auto& [path, value] : is)
    if (!was.contains(path)) found.push_back(fmt::format("{} was not there, is {}", path, value));
  return found;
}

}  // namespace

ReadArray SavedRun::arrays() const {
  hdf5::begin();
  return [state = std::make_shared<StateFile>(file)](const std::string& name, std::size_t first, std::size_t n) {
    return state->read(name, first, n);
  };
}

std::map<std::string, std::vector<double>> SavedRun::state() const {
  hdf5::begin();
  const StateFile arrays(file);
  std::map<std::string, std::vector<double>> all;
  for (const std::string& name : arrays.names())
    all[name] = arrays.read(name, 0, std::numeric_limits<std::size_t>::max());
  return all;
}

SavedRun read_checkpoint(const fs::path& file) {
  try {
    return read(file);
  } catch (const std::exception& e) {
    throw std::runtime_error(fmt::format("{} cannot be used: {}", file.string(), e.what()));
  }
}

Checkpoints::Checkpoints(fs::path folder, const SavedRun* saved)
    : folder_(std::move(folder)),
      place_(saved && saved->file == file(folder_, 0) ? 0 : 1),
      number_(saved ? saved->number : 0) {
  if (!saved) return;
  time_ = saved->so_far.time;
  step_ = saved->so_far.step;
}

void Checkpoints::write(const RunSoFar& so_far, const std::vector<StateArray>& arrays, const FillArrays& fill) {
  nlohmann::json json{{"version", version()}, {"build", build()}, {"number", number_ + 1}, {"run", so_far}};
  json["run"].erase("case_text");
  Writer out(file(folder_, 1 - place_));
  out.text("case", so_far.case_text);
  out.text("run", json.dump(1, ' ', false, nlohmann::json::error_handler_t::replace));
  out.make(arrays);
  if (!fill) out.fill(arrays);
  const fs::path& unfinished = out.close();
  if (fill) fill(unfinished);
  out.finish();
  place_ = 1 - place_;
  ++number_;
  time_ = so_far.time;
  step_ = so_far.step;
}

std::string Checkpoints::last() const {
  return fmt::format("{}, t = {:.6g} s, step {}", file(folder_, place_).string(), time_, step_);
}

fs::path Checkpoints::file(const fs::path& folder, int place) {
  return folder / fmt::format("checkpoint_{}.h5", place);
}

bool Checkpoints::any_in(const fs::path& folder) { return fs::exists(file(folder, 0)) || fs::exists(file(folder, 1)); }

std::optional<SavedRun> newest_checkpoint(const fs::path& folder, const std::vector<Understood>& understood,
                                          const std::function<void(const std::string&)>& refused) {
  std::optional<SavedRun> newest;
  std::vector<std::string> reasons;
  for (int place : {0, 1}) {
    const fs::path file = Checkpoints::file(folder, place);
    if (!fs::exists(file)) continue;
    try {
      SavedRun saved = read_checkpoint(file);
      const std::vector<std::string> other =
          differences(read_case_text(saved.so_far.case_file, saved.so_far.case_text).understood, understood);
      if (!other.empty())
        throw std::runtime_error(
            fmt::format("{} cannot be used: it is of another case:\n  {}", file.string(), fmt::join(other, "\n  ")));
      if (!newest || saved.number > newest->number) newest = std::move(saved);
    } catch (const std::runtime_error& e) {
      reasons.push_back(e.what());
    }
  }
  if (!newest && !reasons.empty()) throw InputError(fmt::format("{}", fmt::join(reasons, "\n")));
  for (const std::string& why : reasons) refused(why);
  return newest;
}

}  // namespace talus
