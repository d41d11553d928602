#pragma once
/// How the processes of a run exchange messages. libtalus_mpi.so implements it with MPI; talus itself links no MPI and loads
/// that library only if a launcher has started several processes.

#include <stdexcept>
#include <string>
#include <vector>

#include "talus/mpm/backend.hpp"

namespace talus {

/// What a process has sent so far.
struct Traffic {
  long n_messages = 0, n_bytes = 0;
};

/// Another process of the run has reported an error, with this message.
class ReportedElsewhere : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// All processes call the same functions in the same order, on the thread that has connected them. After a failure, reported
/// here or elsewhere, every function but `finish` throws ReportedElsewhere.
class Transport {
 public:
  virtual ~Transport() = default;

  virtual int n_processes() const = 0;
  virtual int process() const = 0;  ///< the number of this one, from 0
  virtual int n_on_this_machine() const = 0;

  /// As in Backend.
  virtual std::vector<Message> exchange(std::vector<Message> messages) = 0;
  virtual std::vector<Message> exchange_sized(std::vector<Message> messages, const std::vector<std::size_t>& sizes) = 0;
  virtual std::vector<Message> gather(const Message& message) = 0;
  virtual std::vector<Message> gather_at_first(const Message& message) = 0;
  /// The message of process 0.
  virtual Message broadcast(Message message) = 0;

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
