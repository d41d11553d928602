/// libtalus_mpi.so: messages between the processes of a run, by MPI.
///
/// Only the thread that has connected the processes calls MPI. It waits by asking again and again, and sleeps in between
/// when that takes long, so that processes may share a processor and an error elsewhere ends every wait.

#include <mpi.h>
#include <sched.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <climits>
#include <cstring>
#include <fstream>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "talus/backend/mpi/shared_hdf5.hpp"
#include "talus/backend/mpi/tile_division.hpp"
#include "talus/backend/transport.hpp"

namespace talus {

namespace {

using Clock = std::chrono::steady_clock;

/// Where process numbers of the system mean the same: the machine since its start, and the container.
std::string namespace_of_processes() {
  std::string boot;
  std::ifstream("/proc/sys/kernel/random/boot_id") >> boot;
  char container[64] = {};
  if (::readlink("/proc/self/ns/pid", container, sizeof container - 1) < 0) container[0] = 0;
  return boot + container;
}

constexpr int exit_code = 3;  ///< of a run that has failed

std::atomic<bool> asked_to_end = false;
void note_request_to_end(int) { asked_to_end = true; }

/// Looks a hundred times a second whether processes of this machine are still there. If one is not, the first one left
/// prints the last words, and all end: nobody may wait for the dead. mpirun, too, ends all with SIGTERM then, maybe earlier
/// than this one has looked; so where nothing else handles the signal, it ends the process a tenth of a second later.
class Watch {
 public:
  struct Process {
    int number;
    pid_t pid;
  };

  void start(int own, std::vector<Process> on_this_machine) {
    own_ = own;
    processes_ = std::move(on_this_machine);
    struct sigaction note {};
    note.sa_handler = note_request_to_end;
    note.sa_flags = SA_RESTART;
    sigaction(SIGTERM, &note, &before_);
    thread_ = std::thread([this] { watch(); });
  }
  ~Watch() { stop(); }
  void stop() {
    stopped_ = true;
    if (!thread_.joinable()) return;
    thread_.join();
    sigaction(SIGTERM, &before_, nullptr);
    if (asked_to_end) ::raise(SIGTERM);
  }
  void set_last_words(const std::string& text) {
    const std::lock_guard lock(mutex_);
    last_words_ = text;
  }
  /// Prints a text and the last words.
  void say(const std::string& text) {
    const std::lock_guard lock(mutex_);
    const std::string line = text + last_words_ + "\n";
    if (::write(STDERR_FILENO, line.data(), line.size()) < 0) ::_exit(exit_code);
  }

 private:
  static bool is_gone(const Process& p) { return ::kill(p.pid, 0) != 0 && errno == ESRCH; }

  void watch() {
    for (int rounds_since_request = 0; !stopped_;) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));  // mpirun soon stops passing on what processes print
      const auto gone = std::find_if(processes_.begin(), processes_.end(), is_gone);
      if (gone != processes_.end() && !stopped_) end_after(gone->number);
      if (asked_to_end && ++rounds_since_request == 10) {
        sigaction(SIGTERM, &before_, nullptr);
        ::kill(::getpid(), SIGTERM);
      }
    }
  }
  [[noreturn]] void end_after(int number) {
    ::signal(SIGTERM, SIG_IGN);  // of mpirun, which a second later ends what is left
    const auto first = std::find_if_not(processes_.begin(), processes_.end(), is_gone);
    if (first->number == own_) {
      say("talus: process " + std::to_string(number) + " of the run was killed or has crashed");
    }
    std::this_thread::sleep_for(
        std::chrono::milliseconds(500));  // until the first one has printed, and others have seen it
    ::_exit(exit_code);
  }

  int own_ = 0;
  std::vector<Process> processes_;
  struct sigaction before_ {};  ///< what SIGTERM did
  std::atomic<bool> stopped_ = false;
  std::mutex mutex_;
  std::string last_words_;
  std::thread thread_;
};

class Mpi final : public Transport {
 public:
  Mpi(int* argc, char*** argv) {
    int provided;
    MPI_Init_thread(argc, argv, MPI_THREAD_FUNNELED, &provided);
    MPI_Comm_size(MPI_COMM_WORLD, &n_);
    MPI_Comm_rank(MPI_COMM_WORLD, &own_);
    MPI_Comm_dup(MPI_COMM_WORLD, &messages_);
    MPI_Comm_dup(MPI_COMM_WORLD, &failures_);
    MPI_Comm_dup(MPI_COMM_WORLD, &of_libraries_);
    division_.emplace(of_libraries_);
    start_watch();
  }

  int n_processes() const override { return n_; }
  int process() const override { return own_; }
  int n_on_this_machine() const override { return n_here_; }

  std::vector<int> divide(int dim, const std::vector<int>& places, const std::vector<long>& work,
                          long n_steps) override {
    expect_no_failure();
    if (work.empty()) return {};
    const TilesOfRun tiles{dim, &places, &work};
    std::vector<int> owners;
    const auto find_owners = [&] {
      owners.clear();
      for (const Message& parts : gather(division_->parts(tiles)))
        for (const double part : parts) owners.push_back(int(part));
    };
    if (division_->is_cut(dim)) find_owners();
    if (owners.empty() || loss_.calls_for_a_cut(owners, work, n_, n_steps)) {
      division_->cut(tiles);
      find_owners();
      loss_.start(owners, work, n_);
    }
    return owners;
  }

  std::vector<Message> exchange(std::vector<Message> messages) override {
    expect_no_failure();
    std::vector<long> sent(size()), received(size());
    for (std::size_t o = 0; o < size(); ++o) sent[o] = long(messages[o].size());
    std::vector<MPI_Request> request(1);
    MPI_Ialltoall(sent.data(), 1, MPI_LONG, received.data(), 1, MPI_LONG, messages_, request.data());
    traffic_.n_messages += n_ - 1;
    traffic_.n_bytes += long(sizeof(long)) * (n_ - 1);
    wait(request);
    return exchange_sized(std::move(messages), {received.begin(), received.end()});
  }

  std::vector<Message> exchange_sized(std::vector<Message> messages, const std::vector<std::size_t>& sizes) override {
    Exchange all = start(std::move(messages), sizes);
    wait(all.requests);
    return std::move(all.received);
  }

  void begin_exchange(std::vector<Message> messages, const std::vector<std::size_t>& sizes) override {
    finish_exchange();
    under_way_ = start(std::move(messages), sizes);
  }
  std::vector<Message> finish_exchange() override {
    expect_no_failure();
    wait(under_way_.requests);
    return std::exchange(under_way_, {}).received;
  }
  bool advance_exchange() override {
    if (under_way_.requests.empty()) return false;
    // So seldom that it costs nothing, so often that a message of several pieces keeps moving.
    const auto now = Clock::now();
    if (now - advanced_ < std::chrono::microseconds(50)) return true;
    advanced_ = now;
    int done = 0;
    MPI_Testall(int(under_way_.requests.size()), under_way_.requests.data(), &done, MPI_STATUSES_IGNORE);
    if (done) under_way_.requests.clear();
    return !done;
  }

  std::vector<Message> gather(const Message& message) override {
    const std::vector<long> sizes = sizes_of_all(message);
    std::vector<int> counts, begins;
    long n = 0;
    for (const long s : sizes) {
      counts.push_back(int(s));
      begins.push_back(int(n));
      n += s;
    }
    if (n > INT_MAX) return exchange_sized(std::vector<Message>(size(), message), {sizes.begin(), sizes.end()});
    Message all(static_cast<std::size_t>(n));
    std::vector<MPI_Request> request(1);
    MPI_Iallgatherv(message.data(), int(message.size()), MPI_DOUBLE, all.data(), counts.data(), begins.data(),
                    MPI_DOUBLE, messages_, request.data());
    count(message.size(), n_ - 1);
    wait(request);
    std::vector<Message> parts;
    for (std::size_t o = 0; o < size(); ++o)
      parts.emplace_back(all.data() + begins[o], all.data() + begins[o] + counts[o]);
    return parts;
  }

  std::vector<Message> gather_at_first(const Message& message) override {
    const std::vector<long> sizes = sizes_of_all(message);
    std::vector<Message> all;
    std::vector<MPI_Request> requests;
    if (own_ != 0) {
      send(message, 0, requests);
    } else {
      for (const long s : sizes) all.emplace_back(s);
      all[0] = message;
      for (int o = 1; o < n_; ++o)
        for_each_piece(all[std::size_t(o)], [&](double* p, int n) {
          MPI_Irecv(p, n, MPI_DOUBLE, o, 0, messages_, &requests.emplace_back());
        });
    }
    wait(requests);
    return all;
  }

  Message broadcast(Message message) override {
    expect_no_failure();
    long n = long(message.size());
    std::vector<MPI_Request> request(1);
    MPI_Ibcast(&n, 1, MPI_LONG, 0, messages_, request.data());
    wait(request);
    message.resize(std::size_t(n));
    std::vector<MPI_Request> requests;
    for_each_piece(
        message, [&](double* p, int part) { MPI_Ibcast(p, part, MPI_DOUBLE, 0, messages_, &requests.emplace_back()); });
    wait(requests);
    if (own_ == 0) count(message.size() + 1, n_ - 1);
    return message;
  }

  std::unique_ptr<SharedFile> open_shared(const std::string& file) override {
    expect_no_failure();
    return std::make_unique<SharedHdf5>(of_libraries_, file, [this](const std::string& reason) {
      watch_.say("talus: process " + std::to_string(own_) + " of " + std::to_string(n_) + ": " + reason);
      MPI_Abort(MPI_COMM_WORLD, exit_code);
    });
  }

  void fail(const std::string& text) override {
    if (has_failed_) return;
    has_failed_ = true;
    for (int o = 0; o < n_; ++o)
      if (o != own_) MPI_Send(text.data(), int(text.size()), MPI_CHAR, o, 0, failures_);
  }
  void set_last_words(const std::string& text) override { watch_.set_last_words(text); }

  void finish() override {
    watch_.stop();
    try {
      finish_exchange();
      std::vector<MPI_Request> request(1);
      MPI_Ibarrier(messages_, request.data());
      wait(request);
    } catch (const ReportedElsewhere&) {  // the others do not wait either
    }
    division_.reset();
    MPI_Finalize();
  }

  Traffic traffic() const override { return traffic_; }

 private:
  /// Messages to and from all processes, where they are until MPI is done with them.
  struct Exchange {
    std::vector<Message> sent, received;
    std::vector<MPI_Request> requests;
  };

  std::size_t size() const { return std::size_t(n_); }

  void start_watch() {
    constexpr int length = 128;
    char here[length] = {};
    std::strncpy(here, namespace_of_processes().c_str(), length - 1);
    std::vector<char> places(size() * length);
    MPI_Allgather(here, length, MPI_CHAR, places.data(), length, MPI_CHAR, messages_);
    const int pid = ::getpid();
    std::vector<int> pids(size());
    MPI_Allgather(&pid, 1, MPI_INT, pids.data(), 1, MPI_INT, messages_);
    std::vector<Watch::Process> processes;
    for (int o = 0; o < n_; ++o)
      if (std::strcmp(here, &places[std::size_t(o) * length]) == 0) processes.push_back({o, pids[std::size_t(o)]});
    n_here_ = int(processes.size());
    watch_.start(own_, std::move(processes));
  }

  /// MPI counts numbers with an int.
  template <class Numbers, class F>
  static void for_each_piece(Numbers& numbers, F f) {
    constexpr std::size_t longest = std::size_t(1) << 27;
    for (std::size_t i = 0; i < numbers.size(); i += longest)
      f(numbers.data() + i, int(std::min(longest, numbers.size() - i)));
  }
  Exchange start(std::vector<Message> messages, const std::vector<std::size_t>& sizes) {
    expect_no_failure();
    Exchange all{std::move(messages), std::vector<Message>(size()), {}};
    for (int o = 0; o < n_; ++o) {
      Message& from = all.received[std::size_t(o)];
      if (o == own_) {
        from = std::move(all.sent[std::size_t(o)]);
        continue;
      }
      from.resize(sizes[std::size_t(o)]);
      for_each_piece(
          from, [&](double* p, int n) { MPI_Irecv(p, n, MPI_DOUBLE, o, 0, messages_, &all.requests.emplace_back()); });
    }
    for (int k = 1; k < n_; ++k) {
      const int o = (own_ + k) % n_;
      send(all.sent[std::size_t(o)], o, all.requests);
    }
    return all;
  }
  void send(const Message& message, int to, std::vector<MPI_Request>& requests) {
    for_each_piece(message, [&](const double* p, int n) {
      MPI_Isend(p, n, MPI_DOUBLE, to, 0, messages_, &requests.emplace_back());
      count(std::size_t(n), 1);
    });
  }
  std::vector<long> sizes_of_all(const Message& message) {
    expect_no_failure();
    const long own = long(message.size());
    std::vector<long> sizes(size());
    std::vector<MPI_Request> request(1);
    MPI_Iallgather(&own, 1, MPI_LONG, sizes.data(), 1, MPI_LONG, messages_, request.data());
    count(1, n_ - 1);
    wait(request);
    return sizes;
  }
  /// So many numbers to so many processes.
  void count(std::size_t n_numbers, int n_receivers) {
    traffic_.n_messages += n_receivers;
    traffic_.n_bytes += long(sizeof(double) * n_numbers) * n_receivers;
  }

  void expect_no_failure() const {
    if (has_failed_) throw ReportedElsewhere(failure_);
  }
  void look_for_failure() {
    int found = 0;
    MPI_Status status;
    MPI_Iprobe(MPI_ANY_SOURCE, 0, failures_, &found, &status);
    if (!found) return;
    int n;
    MPI_Get_count(&status, MPI_CHAR, &n);
    failure_.resize(std::size_t(n));
    MPI_Recv(failure_.data(), n, MPI_CHAR, status.MPI_SOURCE, 0, failures_, MPI_STATUS_IGNORE);
    has_failed_ = true;
    failure_ = "process " + std::to_string(status.MPI_SOURCE) + " of " + std::to_string(n_) + ": " + failure_;
    throw ReportedElsewhere(failure_);
  }
  void wait(std::vector<MPI_Request>& requests) {
    const auto start = Clock::now();
    wait_from(start, requests);
    traffic_.seconds += std::chrono::duration<double>(Clock::now() - start).count();
  }
  void wait_from(Clock::time_point start, std::vector<MPI_Request>& requests) {
    // Where processes share processors, one that asks takes the time of one that works.
    static const int n_processors = int(std::thread::hardware_concurrency());
    const bool is_crowded = n_here_ > n_processors;
    const Clock::duration asks = is_crowded ? std::chrono::microseconds(20) : std::chrono::milliseconds(5);
    for (long round = 0;; ++round) {
      int done = 0;
      MPI_Testall(int(requests.size()), requests.data(), &done, MPI_STATUSES_IGNORE);
      if (done) return;
      if (round < 200) continue;
      const auto waited = Clock::now() - start;
      if (waited < asks) {
        ::sched_yield();
        continue;
      }
      look_for_failure();
      std::this_thread::sleep_for(std::chrono::microseconds(waited < std::chrono::milliseconds(200) ? 50 : 1000));
    }
  }

  int n_ = 1, own_ = 0, n_here_ = 1;
  MPI_Comm messages_ = MPI_COMM_NULL, failures_ = MPI_COMM_NULL, of_libraries_ = MPI_COMM_NULL;
  std::optional<TileDivision> division_;
  LossOfDivision loss_;
  Exchange under_way_;
  Clock::time_point advanced_{};  ///< when its messages have last been looked after
  Traffic traffic_;
  bool has_failed_ = false;
  std::string failure_ = "the run has failed";
  Watch watch_;
};

}  // namespace

}  // namespace talus

extern "C" __attribute__((visibility("default"))) talus::Transport* talus_connect_processes(int* argc, char*** argv) {
  static talus::Mpi mpi(argc, argv);
  return &mpi;
}
