#pragma once
/// What depends on the compiler or the processor: the only conditional compilation of talus.

#if defined(__CUDACC__)
#define TALUS_HD __host__ __device__
#else
#define TALUS_HD
#endif

#if defined(__FMA__) || defined(__CUDA_ARCH__)
#define TALUS_HAS_FMA 1
#else
#define TALUS_HAS_FMA 0
#endif

namespace talus {

/// Whether `a * b + c` is one rounding on the target. Everywhere else the compiler is told not to contract
/// (`-ffp-contract=off`), so that scalar code and code for several particles at once give the same bits.
inline constexpr bool has_fma = TALUS_HAS_FMA;

}  // namespace talus
