#include "talus/output/checkpoint.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>
#include <zlib.h>

#include <cstring>
#include <stdexcept>

#include "talus/base/error.hpp"
#include "talus/base/file.hpp"
#include "talus/base/machine.hpp"

namespace talus {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Schedule, interval, next, last)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(RunSoFar, case_file, case_text, end, time, step, history_bytes, surface_bytes,
                                   gauge_bytes, snapshots, instants, next_snapshot, next_row, pressure_noise, maps,
                                   forces, profile, gauges, map_checksum, peak_kinetic, last_flow, wall_seconds,
                                   cpu_seconds, resumed_at)

namespace {

namespace fs = std::filesystem;

constexpr std::string_view kind = "talus checkpoint ", format = "5\n";
constexpr std::string_view run_so_far = "the run so far";  // the array that holds bytes of JSON, not numbers

std::uint32_t checksum(std::uint32_t before, const void* bytes, std::size_t n) {
  return std::uint32_t(::crc32_z(before, static_cast<const unsigned char*>(bytes), n));
}

/// Writes the parts of a checkpoint and its checksum.
class Writer {
 public:
  explicit Writer(const fs::path& file) : file_(file) {}
  void bytes(const void* p, std::size_t n) {
    if (n == 0) return;  // zlib reads the null pointer of an empty array as the start of a sum
    sum_ = checksum(sum_, p, n);
    file_.write(p, n);
  }
  void array(std::string_view name, const void* p, std::size_t n) {
    for (std::string_view part : {name, std::string_view(static_cast<const char*>(p), n)}) {
      const std::uint64_t length = part.size();
      bytes(&length, sizeof length);
      bytes(part.data(), part.size());
    }
  }
  void finish() {
    const std::uint32_t sum = sum_;
    bytes(&sum, sizeof sum);
    file_.finish_on_disk();
  }

 private:
  WholeFile file_;
  std::uint32_t sum_ = 0;
};

/// Reads the parts of a checkpoint one after another.
class Reader {
 public:
  explicit Reader(std::string_view rest) : rest_(rest) {}
  bool at_end() const { return rest_.empty(); }
  std::string_view part() {
    std::uint64_t length;
    std::memcpy(&length, next(sizeof length).data(), sizeof length);
    return next(length);
  }

 private:
  std::string_view next(std::size_t n) {
    if (n > rest_.size()) throw std::runtime_error("its parts do not fit together");
    const std::string_view bytes = rest_.substr(0, n);
    rest_.remove_prefix(n);
    return bytes;
  }
  std::string_view rest_;
};

SavedRun read(const fs::path& file) {
  const std::string content = contents_of(file);
  std::string_view rest = content;
  if (rest.substr(0, kind.size()) != kind) throw std::runtime_error("it is no checkpoint of talus");
  rest.remove_prefix(kind.size());
  if (rest.substr(0, format.size()) != format)
    throw std::runtime_error("it is of another format than this version of talus writes, or damaged");
  std::uint32_t sum;
  if (rest.size() < format.size() + sizeof sum) throw std::runtime_error("it is cut off");
  const std::size_t summed = content.size() - sizeof sum;
  std::memcpy(&sum, &content[summed], sizeof sum);
  if (checksum(0, content.data(), summed) != sum)
    throw std::runtime_error("it is damaged: cut off, or changed since it was written (its checksum does not fit)");

  SavedRun saved;
  saved.file = file;
  for (Reader parts(rest.substr(format.size(), rest.size() - format.size() - sizeof sum)); !parts.at_end();) {
    const std::string name(parts.part());
    const std::string_view values = parts.part();
    if (name == run_so_far) {
      const auto json = nlohmann::json::parse(values);
      for (const auto& [key, mine] : {std::pair{"version", version()}, std::pair{"build", build()}})
        if (const std::string its = json.at(key); !same_bits(its, mine))
          throw std::runtime_error(
              fmt::format("the run was begun by {} {}, and this is {}: another one may give other bits",
                          key == std::string_view("version") ? "talus" : "the build", its, mine));
      saved.number = json.at("number");
      saved.so_far = json.at("run");
    } else {
      std::vector<double>& numbers = saved.state[name];
      numbers.resize(values.size() / sizeof(double));
      if (!numbers.empty()) std::memcpy(numbers.data(), values.data(), numbers.size() * sizeof(double));
    }
  }
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

void SavedRun::restore(Simulation& simulation) const {
  simulation.restore([&](const std::string& name) {
    const auto found = state.find(name);
    if (found == state.end()) throw std::runtime_error(fmt::format("{} does not hold `{}`", file.string(), name));
    return found->second;
  });
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

void Checkpoints::write(const RunSoFar& so_far, const Simulation& simulation) {
  Writer out(file(folder_, 1 - place_));
  out.bytes(kind.data(), kind.size());
  out.bytes(format.data(), format.size());
  const std::string text =
      nlohmann::json{{"version", version()}, {"build", build()}, {"number", number_ + 1}, {"run", so_far}}.dump(
          -1, ' ', false, nlohmann::json::error_handler_t::replace);
  out.array(run_so_far, text.data(), text.size());
  simulation.save([&](const std::string& name, std::span<const double> values) {
    out.array(name, values.data(), values.size_bytes());
  });
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
  return folder / fmt::format("checkpoint_{}.talus", place);
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
