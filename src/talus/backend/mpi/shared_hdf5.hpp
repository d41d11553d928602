#pragma once
/// Files that all processes write together, by parallel HDF5. Its library has other names for its functions (by their versions)
/// than the serial one, which talus links, so that both may be in one program.

#include <hdf5.h>
#include <mpi.h>

#include <functional>

#include "talus/backend/transport.hpp"

namespace talus {

class SharedHdf5 final : public SharedFile {
 public:
  /// `give_up(reason)` is called if something fails, and does not return.
  SharedHdf5(MPI_Comm processes, std::string file, std::function<void(const std::string&)> give_up);

  void write(const std::string& dataset, std::size_t first, int components, const std::vector<double>& values) override;
  void close() override;

 private:
  /// Gives up if a function of HDF5 has failed.
  template <class Result>
  Result expect(Result result, const char* action) const {
    if (result < 0) give_up_(file_name_ + " cannot be written: parallel HDF5 could not " + action);
    return result;
  }

  MPI_Comm processes_;
  std::string file_name_;
  std::function<void(const std::string&)> give_up_;
  hid_t file_, together_;
};

}  // namespace talus
