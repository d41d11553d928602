/// What talus knows of a launcher before it loads MPI.

#include "talus/backend/processes.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "app/program.hpp"

namespace talus::processes_test {

/// Environment variables of launchers, gone at the end of a test.
class ALauncher : public testing::Test {
 protected:
  void TearDown() override {
    for (const char* name : {"OMPI_COMM_WORLD_SIZE", "OMPI_COMM_WORLD_RANK", "PMI_SIZE", "PMI_RANK", "PMIX_RANK",
                             "SLURM_STEP_ID", "SLURM_STEP_NUM_TASKS"})
      ::unsetenv(name);
  }
  void set(const char* name, const char* value) { ::setenv(name, value, 1); }
};

TEST_F(ALauncher, IsNotThereUnlessTheEnvironmentNamesOne) {
  EXPECT_EQ(launched().n_processes, 1);
  EXPECT_EQ(launched().process, 0);
}

TEST_F(ALauncher, OfOpenMpiGivesTheNumberOfProcesses) {
  set("OMPI_COMM_WORLD_SIZE", "4");
  set("OMPI_COMM_WORLD_RANK", "3");
  EXPECT_EQ(launched().n_processes, 4);
  EXPECT_EQ(launched().process, 3);
  EXPECT_EQ(launched().launcher, "mpirun -n");
}

TEST_F(ALauncher, OfSlurmIsNamedInTheCommandToResume) {
  set("PMIX_RANK", "2");
  set("SLURM_STEP_ID", "0");
  set("SLURM_STEP_NUM_TASKS", "8");
  EXPECT_EQ(launched().n_processes, 8);
  EXPECT_EQ(launched().process, 2);
  EXPECT_EQ(launched().launcher, "srun -n");
}

TEST_F(ALauncher, OfSeveralProcessesIsRefusedOnceByATalusWithoutMpi) {
  const std::filesystem::path build = std::filesystem::path(TALUS_PROGRAM).parent_path();
  if (std::filesystem::exists(build / "lib/libtalus_mpi.so")) GTEST_SKIP() << "this build has MPI";
  const auto first = program::talus("list", "OMPI_COMM_WORLD_SIZE=2 OMPI_COMM_WORLD_RANK=0"),
             second = program::talus("list", "OMPI_COMM_WORLD_SIZE=2 OMPI_COMM_WORLD_RANK=1");
  EXPECT_EQ(first.code, 2);
  EXPECT_TRUE(program::has(first.output, "mpirun -n 2 has started 2 processes, but this talus was built without MPI"))
      << first.output;
  EXPECT_EQ(second.code, 2);
  EXPECT_EQ(second.output, "");
}

}  // namespace talus::processes_test
