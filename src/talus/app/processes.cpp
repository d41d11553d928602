#include "talus/app/processes.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <csignal>
#include <optional>
#include <sstream>
#include <type_traits>
#include <utility>

#include "talus/app/commands.hpp"
#include "talus/backend/backend.hpp"
#include "talus/base/error.hpp"
#include "talus/base/image.hpp"
#include "talus/base/machine.hpp"
#include "talus/input/read.hpp"
#include "talus/output/snapshot.hpp"

namespace talus {

namespace {

/// What process 0 asks of the others. A message with its number comes first, then what it needs.
enum class Request {
  make,  ///< threads, then name and text of the case
  destroy,
  step,
  observe,
  places,
  flow,
  pressures,
  describe,  ///< number of the particle
  next_dt,
  save,
  fill_state,  ///< then the name of the file
  snapshot,    ///< then name and fields
  restore,     ///< then the arrays that the simulation reads, piece by piece
  load,
  last_words,  ///< then the text
  disconnect,
};

Message packed(const std::string& text) { return Message(text.begin(), text.end()); }
std::string unpacked(const Message& message) {
  std::string text;
  for (const double character : message) text += char(character);
  return text;
}

Message load_of(const Simulation& simulation, const Transport& transport) {
  const Share share = simulation.share();
  const Traffic traffic = transport.traffic();
  return {double(share.n_particles), double(share.n_tiles), double(share.n_neighbours), double(traffic.n_messages),
          double(traffic.n_bytes),   traffic.seconds,       double(simulation.bytes())};
}
constexpr std::size_t bytes_in_load = 6;

/// Start of all processes: each reads the case; an error of one stops all.
std::unique_ptr<Simulation> make_part(Transport& transport, const Case* case_of_first, const std::string& file,
                                      const std::string& text, Backend& backend) {
  std::optional<CaseFile> own;
  std::string why;
  if (!case_of_first) try {
      own = read_case_text(file, text);
    } catch (const std::exception& e) {
      why = e.what();
    }
  const std::vector<Message> reasons = transport.gather(packed(why));
  for (std::size_t o = 0; o < reasons.size(); ++o)
    if (!reasons[o].empty())
      throw InputError(fmt::format("process {} cannot read the case as process 0 does; all need the same files:\n{}", o,
                                   unpacked(reasons[o])));
  return make_simulation(case_of_first ? *case_of_first : own->case_, backend);
}

/// Writes the parts of all processes into a checkpoint.
void fill_state_together(Transport& transport, const std::string& file, const std::vector<StateArray>& arrays) {
  const std::unique_ptr<SharedFile> shared = transport.open_shared(file);
  for (const StateArray& array : arrays) shared->write("state/" + array.name, array.first, 1, array.part());
  shared->close();
  transport.gather({});  // all have written
}

/// Writes a snapshot of all processes. Returns why it cannot be written, in process 0; empty if it is.
std::string write_snapshot_together(Transport& transport, Simulation& simulation, const std::string& file,
                                    const std::vector<std::string>& fields) {
  const ObservedPart part = simulation.observe_part(fields);
  std::optional<UnfilledSnapshot> snapshot;
  std::string why;
  if (transport.process() == 0) try {
      snapshot.emplace(file, part, fields);
    } catch (const std::exception& e) {
      why = e.what();
    }
  const std::string unfinished = unpacked(transport.broadcast(packed(snapshot ? snapshot->file().string() : "")));
  if (unfinished.empty()) return why;
  const std::unique_ptr<SharedFile> shared = transport.open_shared(unfinished);
  fill_snapshot(part, fields, [&](const std::string& dataset, std::size_t first, int components, const auto& values) {
    shared->write(dataset, first, components, values);
  });
  shared->close();
  transport.gather({});  // all have written
  if (snapshot) try {
      snapshot->finish();
    } catch (const std::exception& e) {
      why = e.what();
    }
  return why;
}

Message packed_lines(const std::vector<std::string>& lines) {
  return packed(fmt::format("{}", fmt::join(lines, "\n")));
}
std::vector<std::string> unpacked_lines(const Message& message) {
  std::istringstream text(unpacked(message));
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  return lines;
}

/// The simulation of all processes, as process 0 sees it.
class SharedSimulation final : public Simulation {
 public:
  SharedSimulation(Transport& transport, std::unique_ptr<Simulation> own)
      : transport_(transport), own_(std::move(own)) {}
  ~SharedSimulation() override {
    try {
      order(Request::destroy);
    } catch (const ReportedElsewhere&) {  // of which the program has heard
    }
  }

  void step() override {
    together(Request::step, [&] { own_->step(); });
  }
  const Ledger& ledger() const override { return own_->ledger(); }
  const StepTally& tally() const override { return own_->tally(); }
  const std::vector<SurfaceAccount>& surfaces() const override { return own_->surfaces(); }
  Observation observe(const std::vector<std::string>& fields) override {
    return together(Request::observe, [&] {
      transport_.broadcast(packed_lines(fields));
      return own_->observe(fields);
    });
  }
  ObservedPart observe_part(const std::vector<std::string>&) override {
    throw std::logic_error("processes observe their parts when they write them");
  }
  ParticlePlaces places() const override {
    return together(Request::places, [&] { return own_->places(); });
  }
  FlowPoints flow() const override {
    return together(Request::flow, [&] { return own_->flow(); });
  }
  std::vector<TilePressure> pressures() const override {
    return together(Request::pressures, [&] { return own_->pressures(); });
  }
  std::string describe(long particle) const override {
    return together(
        Request::describe, [&] { return own_->describe(particle); }, double(particle));
  }
  long n_particles() const override { return own_->n_particles(); }
  long n_tiles() const override { return long(total(1)); }
  std::size_t bytes() const override { return std::size_t(total(bytes_in_load)); }
  Share share() const override { return own_->share(); }
  double next_dt() const override {
    return together(Request::next_dt, [&] { return own_->next_dt(); });
  }
  std::vector<StateArray> save() const override {
    arrays_ = together(Request::save, [&] { return own_->save(); });
    std::vector<StateArray> arrays = arrays_;
    for (StateArray& array : arrays)
      array.part = []() -> std::vector<double> { throw std::logic_error("processes write their parts together"); };
    return arrays;
  }
  /// Writes what was saved last, once.
  void fill(const std::string& file) const {
    together(Request::fill_state, [&] {
      transport_.broadcast(packed(file));
      fill_state_together(transport_, file, arrays_);
    });
    arrays_.clear();
  }
  void write_snapshot(const std::string& file, const std::vector<std::string>& fields) {
    const std::string why = together(Request::snapshot, [&] {
      transport_.broadcast(packed(file));
      transport_.broadcast(packed_lines(fields));
      return write_snapshot_together(transport_, *own_, file, fields);
    });
    if (!why.empty()) throw std::runtime_error(why);
  }
  void restore(const ReadArray& read) override {
    together(Request::restore, [&] {
      own_->restore([&](const std::string& name, std::size_t first, std::size_t n) {
        try {
          Message values = read(name, first, n);
          values.push_back(0);  // no error
          values = transport_.broadcast(std::move(values));
          values.pop_back();
          return values;
        } catch (const ReportedElsewhere&) {
          throw;
        } catch (const std::exception&) {
          transport_.broadcast({1});
          throw;
        }
      });
    });
  }

  std::vector<Message> loads() const {
    return together(Request::load, [&] { return transport_.gather(load_of(*own_, transport_)); });
  }

 private:
  void order(Request request, double argument = 0) const { transport_.broadcast({double(request), argument}); }
  /// Has all processes do the same. A RunError, or an InputError, is one of all; of any other the rest do not know.
  template <class F>
  std::invoke_result_t<F> together(Request what, F f, double argument = 0) const {
    order(what, argument);
    try {
      return f();
    } catch (const RunError&) {
      throw;
    } catch (const ReportedElsewhere&) {
      throw;
    } catch (const std::exception& e) {
      if (what != Request::restore) transport_.fail(e.what());
      throw;
    }
  }
  double total(std::size_t column) const {
    double sum = 0;
    for (const Message& load : loads()) sum += load[column];
    return sum;
  }

  Transport& transport_;
  std::unique_ptr<Simulation> own_;
  mutable std::vector<StateArray> arrays_;  ///< of process 0, as saved last
};

/// A process that does its part of what process 0 orders.
class Follower {
 public:
  explicit Follower(Transport& transport) : transport_(transport) {}

  /// Does what is ordered. Returns false when it was the last order.
  bool obey() {
    const Message order = transport_.broadcast({});
    switch (Request(int(order.at(0)))) {
      case Request::make: make(int(order.at(1))); break;
      case Request::destroy:
        arrays_.clear();
        simulation_.reset();
        break;
      case Request::step: simulation_->step(); break;
      case Request::observe: simulation_->observe(unpacked_lines(transport_.broadcast({}))); break;
      case Request::places: simulation_->places(); break;
      case Request::flow: simulation_->flow(); break;
      case Request::pressures: simulation_->pressures(); break;
      case Request::describe: simulation_->describe(long(order.at(1))); break;
      case Request::next_dt: simulation_->next_dt(); break;
      case Request::save: arrays_ = simulation_->save(); break;
      case Request::fill_state:
        fill_state_together(transport_, unpacked(transport_.broadcast({})), arrays_);
        arrays_.clear();
        break;
      case Request::snapshot: write_snapshot(); break;
      case Request::restore: restore(); break;
      case Request::load: transport_.gather(load_of(*simulation_, transport_)); break;
      case Request::last_words: transport_.set_last_words(unpacked(transport_.broadcast({}))); break;
      case Request::disconnect: return false;
    }
    return true;
  }

 private:
  void make(int threads) {
    const std::string file = unpacked(transport_.broadcast({})), text = unpacked(transport_.broadcast({}));
    simulation_.reset();
    backend_ = make_backend_of_processes(transport_, threads);
    simulation_ = make_part(transport_, nullptr, file, text, *backend_);
  }
  void write_snapshot() {
    const std::string file = unpacked(transport_.broadcast({}));
    const std::vector<std::string> fields = unpacked_lines(transport_.broadcast({}));
    write_snapshot_together(transport_, *simulation_, file, fields);
  }
  void restore() {
    simulation_->restore([&](const std::string&, std::size_t, std::size_t) {
      Message values = transport_.broadcast({});
      if (values.back() != 0) throw InputError("process 0 cannot read the checkpoint");
      values.pop_back();
      return values;
    });
  }

  Transport& transport_;
  std::unique_ptr<Backend> backend_;
  std::unique_ptr<Simulation> simulation_;
  std::vector<StateArray> arrays_;  ///< as saved last
};

}  // namespace

Processes& processes() {
  static Processes all;
  return all;
}

void Processes::connect(int* argc, char*** argv) {
  launched_ = launched();
  if (launched_.n_processes > 1) transport_ = &connect_processes(launched_, argc, argv);
}

int Processes::follow() {
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, SIG_IGN);  // process 0 decides when the run stops
  Follower follower(*transport_);
  int code = 0;
  for (bool goes_on = true; goes_on;) {
    try {
      goes_on = follower.obey();
    } catch (const ReportedElsewhere&) {
      code = exit_failed;
      break;
    } catch (const RunError&) {    // all processes have it, and process 0 says it
    } catch (const InputError&) {  // the same
    } catch (const std::exception& e) {
      transport_->fail(e.what());
      code = exit_failed;
      break;
    }
  }
  transport_->finish();
  return code;
}

void Processes::disconnect() {
  if (!transport_) return;
  try {
    transport_->broadcast({double(Request::disconnect)});
  } catch (const ReportedElsewhere&) {  // they have left
  }
  transport_->finish();
}

std::unique_ptr<Backend> Processes::make_backend(int threads) {
  if (n() == 1) return make_threads(threads);
  threads_ = threads > 0 ? threads : std::max(1, std::min(n_usable_processors(), n_processors() / n_on_this_machine()));
  return make_backend_of_processes(*transport_, threads_);
}

std::unique_ptr<Simulation> Processes::make_simulation(const Case& case_, const std::string& case_file,
                                                       const std::string& case_text, Backend& backend) {
  if (n() == 1) return talus::make_simulation(case_, backend);
  transport_->broadcast({double(Request::make), double(threads_)});
  transport_->broadcast(packed(case_file));
  transport_->broadcast(packed(case_text));
  return std::make_unique<SharedSimulation>(*transport_, make_part(*transport_, &case_, case_file, case_text, backend));
}

void Processes::write_snapshot(Simulation& simulation, const std::filesystem::path& file,
                               const std::vector<std::string>& fields) const {
  if (auto* shared = dynamic_cast<SharedSimulation*>(&simulation))
    shared->write_snapshot(file.string(), fields);
  else
    talus::write_snapshot(file, simulation.observe(), fields);
}

FillArrays Processes::fill_of(const Simulation& simulation) const {
  const auto* shared = dynamic_cast<const SharedSimulation*>(&simulation);
  if (!shared) return {};
  return [shared](const std::filesystem::path& file) { shared->fill(file.string()); };
}

void Processes::set_command_to_resume(const std::string& command) {
  if (n() == 1) return;
  const std::string text = fmt::format("; the run has ended. Resume it with\n  {}", command);
  transport_->broadcast({double(Request::last_words)});
  transport_->broadcast(packed(text));
  transport_->set_last_words(text);
}

std::string Processes::launcher() const { return n() == 1 ? "" : fmt::format("{} {} ", launched_.launcher, n()); }

std::vector<Processes::Load> Processes::loads(const Simulation& simulation) const {
  std::vector<Load> loads;
  if (const auto* shared = dynamic_cast<const SharedSimulation*>(&simulation))
    for (const Message& m : shared->loads())
      loads.push_back({{long(m[0]), long(m[1]), long(m[2])}, {long(m[3]), long(m[4]), m[5]}});
  return loads;
}

}  // namespace talus
