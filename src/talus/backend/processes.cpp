#include "talus/backend/processes.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>

#include "talus/backend/backend.hpp"
#include "talus/base/error.hpp"

namespace talus {

namespace {

/// The value of the first variable that is set and a number.
int number_in_environment(std::initializer_list<const char*> names, int otherwise) {
  for (const char* name : names)
    if (const char* value = std::getenv(name)) {
      char* end;
      const long number = std::strtol(value, &end, 10);
      if (end != value) return int(number);
    }
  return otherwise;
}

class BackendOfProcesses final : public Backend {
 public:
  BackendOfProcesses(Transport& transport, int n_threads) : transport_(transport), threads_(make_threads(n_threads)) {}

  int n_workers() const override { return threads_->n_workers(); }
  using Backend::for_each;
  void for_each(const Shares& shares, const std::function<void(int, int)>& body) override {
    if (!transport_.advance_exchange()) return threads_->for_each(shares, body);
    threads_->for_each(shares, [&](int i, int worker) {
      body(i, worker);
      if (worker == 0) transport_.advance_exchange();  // on the calling thread, as MPI needs it
    });
  }

  int n_owners() const override { return transport_.n_processes(); }
  int owner() const override { return transport_.process(); }
  std::vector<int> divide(int dim, const std::vector<int>& places, const std::vector<long>& work,
                          long n_steps) override {
    return transport_.divide(dim, places, work, n_steps);
  }
  std::vector<Message> exchange(std::vector<Message> messages) override {
    return transport_.exchange(std::move(messages));
  }
  std::vector<Message> exchange_sized(std::vector<Message> messages, const std::vector<std::size_t>& sizes) override {
    return transport_.exchange_sized(std::move(messages), sizes);
  }
  void begin_exchange(std::vector<Message> messages, const std::vector<std::size_t>& sizes) override {
    transport_.begin_exchange(std::move(messages), sizes);
  }
  std::vector<Message> finish_exchange() override { return transport_.finish_exchange(); }
  std::vector<Message> gather(const Message& message) override { return transport_.gather(message); }
  std::vector<Message> gather_at_first(const Message& message) override { return transport_.gather_at_first(message); }

 private:
  Transport& transport_;
  std::unique_ptr<Backend> threads_;
};

}  // namespace

Launched launched() {
  Launched l;
  if (std::getenv("OMPI_COMM_WORLD_SIZE") || std::getenv("PMI_SIZE")) {
    l.n_processes = number_in_environment({"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"}, 1);
    l.process = number_in_environment({"OMPI_COMM_WORLD_RANK", "PMI_RANK"}, 0);
  } else if (std::getenv("PMIX_RANK")) {  // srun --mpi=pmix
    l.n_processes = number_in_environment({"SLURM_STEP_NUM_TASKS", "SLURM_NTASKS"}, 1);
    l.process = number_in_environment({"PMIX_RANK"}, 0);
  }
  const bool by_slurm = std::getenv("SLURM_STEP_ID") && !std::getenv("OMPI_COMM_WORLD_SIZE");
  l.launcher = by_slurm ? "srun -n" : "mpirun -n";
  return l;
}

Transport& connect_processes(const Launched& launched, int* argc, char*** argv) {
  Dl_info here;
  ::dladdr(reinterpret_cast<void*>(&connect_processes), &here);
  const std::filesystem::path folder = std::filesystem::absolute(here.dli_fname).parent_path();
  std::filesystem::path file = folder / "libtalus_mpi.so";
  if (!std::filesystem::exists(file)) file = folder / "lib" / "libtalus_mpi.so";  // where talus is one piece
  if (!std::filesystem::exists(file))
    throw InputError(fmt::format(
        "{} {} has started {} processes, but this talus was built without MPI: there is no libtalus_mpi.so in {}. "
        "Build with -DTALUS_MPI=ON, or start talus without {}",
        launched.launcher, launched.n_processes, launched.n_processes, folder.string(),
        launched.launcher.substr(0, launched.launcher.find(' '))));
  void* library = ::dlopen(file.c_str(), RTLD_NOW | RTLD_GLOBAL);  // stays; MPI loads parts of its own that need it
  if (!library) throw InputError(fmt::format("{} cannot be loaded: {}", file.string(), ::dlerror()));
  const auto connect = reinterpret_cast<ConnectProcesses>(::dlsym(library, connect_function));
  if (!connect) throw InputError(fmt::format("{} is of another version of talus", file.string()));
  Transport& transport = *connect(argc, argv);
  if (transport.n_processes() != launched.n_processes)
    throw InputError(
        fmt::format("{} has started {} processes, and MPI connects {}: libtalus_mpi.so was built for another MPI than "
                    "that of the launcher (with Slurm: srun --mpi=pmix)",
                    launched.launcher, launched.n_processes, transport.n_processes()));
  return transport;
}

std::unique_ptr<Backend> make_backend_of_processes(Transport& transport, int n_threads) {
  return std::make_unique<BackendOfProcesses>(transport, n_threads);
}

}  // namespace talus
