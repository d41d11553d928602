#pragma once
/// Several processes of one run, started by a launcher: mpirun, or srun of Slurm.

#include <memory>
#include <string>

#include "talus/backend/transport.hpp"

namespace talus {

/// What the launcher has told this process by environment variables; one process, number 0, without a launcher.
struct Launched {
  int n_processes = 1, process = 0;
  std::string launcher;  ///< with its option for the number of processes: "mpirun -n"
};
Launched launched();

/// Connects this process with the others. Throws InputError if libtalus_mpi.so is not in the folder of libtalus.so or
/// cannot be loaded.
Transport& connect_processes(const Launched& launched, int* argc, char*** argv);

/// Loops of this process on threads, and messages to the others.
std::unique_ptr<Backend> make_backend_of_processes(Transport& transport, int n_threads);

}  // namespace talus
