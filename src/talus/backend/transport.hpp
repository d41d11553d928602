#pragma once
/// How the processes of a run exchange messages. libtalus_mpi.so implements it with MPI; talus itself links no MPI and loads
/// that library only if a launcher has started several processes.

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "talus/mpm/backend.hpp"

namespace talus {

/// What a process has sent so far, and how long it has waited for others.
struct Traffic {
  long n_messages = 0, n_bytes = 0;
  double seconds = 0;
};

/// Largest work of a process over the mean at which tiles are divided again at once.
inline constexpr double most_imbalance = 1.1;

/// Another process of the run has reported an error, with this message.
class ReportedElsewhere : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// An HDF5 file that exists, into which all processes write. A failure ends the program in all of them, with exit code 3: the
/// others could wait for ever.
class SharedFile {
 public:
  virtual ~SharedFile() = default;
  /// Writes rows of a dataset from row `first` on, `components` numbers in each. All processes call it with the same dataset,
  /// each with other rows, or none.
  virtual void write(const std::string& dataset, std::size_t first, int components,
                     const std::vector<double>& values) = 0;
  /// Returns when the numbers of this process are on the disk.
  virtual void close() = 0;
};

/// All processes call the same functions in the same order, on the thread that has connected them. After a failure, reported
/// here or elsewhere, every function but `finish` throws ReportedElsewhere.
class Transport {
 public:
  virtual ~Transport() = default;

  virtual int n_processes() const = 0;
  virtual int process() const = 0;  ///< the number of this one, from 0
  virtual int n_on_this_machine() const = 0;

  /// As in Backend. `divide` keeps the owners of the call before, extended to other tiles, as long as none of them has more
  /// than `most_imbalance` times the mean work, and less time has been lost to unequal work than a new division takes.
  virtual std::vector<int> divide(int dim, const std::vector<int>& places, const std::vector<long>& work,
                                  long n_steps) = 0;
  virtual std::vector<Message> exchange(std::vector<Message> messages) = 0;
  virtual std::vector<Message> exchange_sized(std::vector<Message> messages, const std::vector<std::size_t>& sizes) = 0;
  virtual void begin_exchange(std::vector<Message> messages, const std::vector<std::size_t>& sizes) = 0;
  virtual std::vector<Message> finish_exchange() = 0;
  /// Lets the messages of the exchange that was begun move on: MPI does so only when it is called. Returns false if none
  /// are on their way.
  virtual bool advance_exchange() = 0;
  virtual std::vector<Message> gather(const Message& message) = 0;
  virtual std::vector<Message> gather_at_first(const Message& message) = 0;
  /// The message of process 0.
  virtual Message broadcast(Message message) = 0;

  virtual std::unique_ptr<SharedFile> open_shared(const std::string& file) = 0;

  /// Reports an error that the other processes do not know of, and that the run cannot survive.
  virtual void fail(const std::string& text) = 0;
  /// What any process prints if another one is killed or crashes; the program then ends with exit code 3.
  virtual void set_last_words(const std::string& text) = 0;
  /// Waits for the others and disconnects. The last call.
  virtual void finish() = 0;

  virtual Traffic traffic() const = 0;
};

/// Name and type of the function of libtalus_mpi.so that connects the processes. Called once in a program.
inline constexpr const char* connect_function = "talus_connect_processes";
using ConnectProcesses = Transport* (*)(int* argc, char*** argv);

}  // namespace talus
