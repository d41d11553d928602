#include "talus/backend/mpi/shared_hdf5.hpp"

#include <algorithm>

namespace talus {

namespace {

constexpr std::size_t longest = std::size_t(1)
                                << 24;  ///< numbers that a process writes at a time; MPI counts with an int

}  // namespace

SharedHdf5::SharedHdf5(MPI_Comm processes, std::string file, std::function<void(const std::string&)> give_up)
    : processes_(processes), file_name_(std::move(file)), give_up_(std::move(give_up)) {
  static const herr_t without_atexit = H5dont_atexit();  // works once, before anything else
  (void)without_atexit;
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  const hid_t access = expect(H5Pcreate(H5P_FILE_ACCESS), "make properties");
  expect(H5Pset_fapl_mpio(access, processes_, MPI_INFO_NULL), "make properties");
  file_ = expect(H5Fopen(file_name_.c_str(), H5F_ACC_RDWR, access), "open it");
  H5Pclose(access);
  together_ = expect(H5Pcreate(H5P_DATASET_XFER), "make properties");
  expect(H5Pset_dxpl_mpio(together_, H5FD_MPIO_COLLECTIVE), "make properties");
}

void SharedHdf5::write(const std::string& dataset, std::size_t first, int components,
                       const std::vector<double>& values) {
  const hid_t set = expect(H5Dopen2(file_, dataset.c_str(), H5P_DEFAULT), "find a dataset");
  const hid_t space = expect(H5Dget_space(set), "find a dataset"), type = expect(H5Dget_type(set), "find a dataset");
  const int rank = expect(H5Sget_simple_extent_ndims(space), "find a dataset");
  const std::size_t width = std::size_t(components), n_rows = values.size() / width;
  const std::size_t rows_at_a_time = std::max(std::size_t(1), longest / width);
  long pieces = long((n_rows + rows_at_a_time - 1) / rows_at_a_time);
  MPI_Allreduce(MPI_IN_PLACE, &pieces, 1, MPI_LONG, MPI_MAX, processes_);
  // HDF5 converts numbers for one process only.
  std::vector<double> converted;
  for (long piece = 0; piece < pieces; ++piece) {
    const std::size_t from = std::min(n_rows, std::size_t(piece) * rows_at_a_time);
    const std::size_t to = std::min(n_rows, from + rows_at_a_time);
    converted.assign(values.data() + from * width, values.data() + to * width);
    expect(H5Tconvert(H5T_NATIVE_DOUBLE, type, converted.size(), converted.data(), nullptr, H5P_DEFAULT),
           "convert numbers");
    const hsize_t begin[2] = {first + from, 0}, size[2] = {to - from, width};
    const hid_t in_memory = expect(H5Screate_simple(rank, size, nullptr), "make a space");
    if (to > from) {
      expect(H5Sselect_hyperslab(space, H5S_SELECT_SET, begin, nullptr, size, nullptr), "select rows");
    } else {
      H5Sselect_none(space);
      H5Sselect_none(in_memory);
    }
    expect(H5Dwrite(set, type, in_memory, space, together_, converted.data()), "write numbers (is the disk full?)");
    H5Sclose(in_memory);
  }
  H5Tclose(type);
  H5Sclose(space);
  expect(H5Dclose(set), "write a dataset");
}

void SharedHdf5::close() {
  expect(H5Fflush(file_, H5F_SCOPE_GLOBAL), "put it on the disk");
  H5Pclose(together_);
  expect(H5Fclose(file_), "close it");
}

}  // namespace talus
