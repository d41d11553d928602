#pragma once
/// Memory that runs out.

namespace talus {

inline constexpr const char* out_of_memory =
    "not enough memory. Use fewer particles (larger `spacing`), or raise the limit (`ulimit -v`)";

/// Where the address space of the process is limited, makes an invalid access to memory end the program with a message
/// and the code of a failure: libraries written in C, HDF5 among them, use memory that they did not get. Without a limit
/// nothing changes.
void report_out_of_memory_in_libraries();

}  // namespace talus
