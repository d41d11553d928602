#pragma once
/// Runs that several processes share.
///
/// Process 0 reads the input, controls the run, prints and writes. The other processes execute the same calls of the
/// simulation on their part of it.

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "talus/backend/processes.hpp"
#include "talus/mpm/simulation.hpp"
#include "talus/output/checkpoint.hpp"

namespace talus {

/// The processes of this program. There is one object, `processes()`.
class Processes {
 public:
  int n() const { return transport_ ? transport_->n_processes() : 1; }
  int n_on_this_machine() const { return transport_ ? transport_->n_on_this_machine() : 1; }
  bool is_first() const { return !transport_ || transport_->process() == 0; }

  /// Meets the other processes, if a launcher has started several. Throws InputError, in process 0 only, if they cannot
  /// meet; the others then end.
  void connect(int* argc, char*** argv);
  /// Main loop of all processes but the first, until the first disconnects. Returns the exit code.
  int follow();
  /// The last call of the first.
  void disconnect();

  /// Where the loops of a run are computed. `threads`: of each process; 0: as many as there are processors for it.
  std::unique_ptr<Backend> make_backend(int threads);
  /// The simulation of a case that was read from a file with this text. `case_file`: its name, in which the others find the
  /// files that it names.
  std::unique_ptr<Simulation> make_simulation(const Case& case_, const std::string& case_file,
                                              const std::string& case_text, Backend& backend);

  /// Writes a snapshot of a simulation, all processes their parts of it. Throws std::runtime_error if it cannot be written.
  void write_snapshot(Simulation& simulation, const std::filesystem::path& file,
                      const std::vector<std::string>& fields) const;
  /// Writes the parts of all processes into a checkpoint; empty for one process.
  FillArrays fill_of(const Simulation& simulation) const;

  /// Command that the processes print when one of them is killed.
  void set_command_to_resume(const std::string& command);
  /// The start of a command that starts as many processes: "mpirun -n 4 "; empty for one.
  std::string launcher() const;
  /// Share of each process and its messages; `simulation` is one of `make_simulation`.
  struct Load {
    Share share;
    Traffic traffic;
  };
  std::vector<Load> loads(const Simulation& simulation) const;

 private:
  Launched launched_;
  Transport* transport_ = nullptr;
  int threads_ = 0;
};

Processes& processes();

}  // namespace talus
