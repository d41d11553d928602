#pragma once
/// Memory that runs out.

namespace talus {

inline constexpr const char* out_of_memory =
    "not enough memory. Use fewer particles (larger `spacing`), or raise the limit (`ulimit -v`)";

/// Where the address space of the process is limited, makes an invalid access to memory, and an exit by a library, end the
/// program with a message and the code of a failure: HDF5 uses memory that it did not get, or leaves without a word.
/// Without a limit nothing changes.
void report_out_of_memory_in_libraries();

}  // namespace talus
