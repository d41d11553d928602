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

#if defined(__clang__)
#define TALUS_COMPILER __VERSION__
#else
#define TALUS_COMPILER "gcc " __VERSION__
#endif

#if defined(__AVX512F__)
#define TALUS_INSTRUCTIONS "x86-64-v4"
#elif TALUS_HAS_FMA
#define TALUS_INSTRUCTIONS "x86-64-v3"
#else
#define TALUS_INSTRUCTIONS "baseline"
#endif

// Small parts of kernels that would otherwise be called, with all they return passed through memory.
#if defined(__CUDACC__)
#define TALUS_INLINE __forceinline__
#elif defined(__SANITIZE_ADDRESS__)
#define TALUS_INLINE inline
#else
#define TALUS_INLINE [[gnu::always_inline]] inline
#endif

// Kernels take in all they call. Not under AddressSanitizer or without AVX, where such functions take minutes to compile,
// and not on a device.
#if defined(__SANITIZE_ADDRESS__) || defined(__CUDACC__) || !defined(__AVX2__)
#define TALUS_FLATTEN
#else
#define TALUS_FLATTEN [[gnu::flatten]]
#endif

// Functions that are not inlined; TALUS_COLD: and rarely called. On a device a call passes its arguments through memory,
// so there nvcc decides.
#if defined(__CUDACC__)
#define TALUS_NOINLINE
#define TALUS_COLD
#else
#define TALUS_NOINLINE [[gnu::noinline]]
#define TALUS_COLD [[gnu::noinline, gnu::cold]]
#endif

#if defined(__CUDACC__)
#include "talus/base/four.hpp"
#endif

namespace talus {

#if defined(__CUDACC__)

using FourDoubles = Four<double>;
using FourMasks = Four<long>;
using FourDoublesAnywhere = FourAnywhere;
using FourBits = Four<unsigned long>;

#else

/// Four doubles, four truth values and the bits of four doubles, side by side: one 256-bit register.
typedef double FourDoubles __attribute__((vector_size(32)));
typedef long FourMasks __attribute__((vector_size(32)));
/// The same doubles in memory, at any address.
typedef double FourDoublesAnywhere __attribute__((vector_size(32), aligned(8), may_alias));
typedef unsigned long FourBits __attribute__((vector_size(32)));

/// a where m is true, b elsewhere.
inline FourDoubles blend(FourMasks m, FourDoubles a, FourDoubles b) { return m ? a : b; }
/// The lanes of a (0 to 3) and b (4 to 7) with these numbers.
template <int i, int j, int k, int l>
inline FourDoubles shuffle(FourDoubles a, FourDoubles b) {
  return __builtin_shufflevector(a, b, i, j, k, l);
}

#if defined(__AVX2__) && defined(__FMA__)
// The compiler takes loops over lanes apart where they meet scalar code; these are single instructions wherever they
// stand.
inline FourDoubles fused_multiply_add(FourDoubles a, FourDoubles b, FourDoubles c) {
  return __builtin_ia32_vfmaddpd256(a, b, c);
}
inline FourDoubles square_roots(FourDoubles x) { return __builtin_ia32_sqrtpd256(x); }
inline FourDoubles floors(FourDoubles x) { return __builtin_ia32_roundpd256(x, 1); }
/// a < b ? b : a, and b < a ? b : a; so a NaN in a stays.
inline FourDoubles larger(FourDoubles a, FourDoubles b) { return __builtin_ia32_maxpd256(b, a); }
inline FourDoubles smaller(FourDoubles a, FourDoubles b) { return __builtin_ia32_minpd256(b, a); }
inline int sign_bits(FourMasks m) { return __builtin_ia32_movmskpd256(reinterpret_cast<FourDoubles>(m)); }
#else
inline FourDoubles fused_multiply_add(FourDoubles a, FourDoubles b, FourDoubles c) {
  for (int i = 0; i < 4; ++i) c[i] = __builtin_fma(a[i], b[i], c[i]);
  return c;
}
inline FourDoubles square_roots(FourDoubles x) {
  for (int i = 0; i < 4; ++i) x[i] = __builtin_sqrt(x[i]);
  return x;
}
inline FourDoubles floors(FourDoubles x) {
  for (int i = 0; i < 4; ++i) x[i] = __builtin_floor(x[i]);
  return x;
}
inline FourDoubles larger(FourDoubles a, FourDoubles b) { return a < b ? b : a; }
inline FourDoubles smaller(FourDoubles a, FourDoubles b) { return b < a ? b : a; }
inline int sign_bits(FourMasks m) {
  int bits = 0;
  for (int i = 0; i < 4; ++i) bits |= (m[i] < 0) << i;
  return bits;
}
#endif
inline FourDoubles magnitudes(FourDoubles x) {
  return reinterpret_cast<FourDoubles>(reinterpret_cast<FourMasks>(x) & 0x7fffffffffffffff);
}
inline FourBits bits_of(FourDoubles x) { return reinterpret_cast<FourBits>(x); }
inline FourDoubles doubles_of(FourBits bits) { return reinterpret_cast<FourDoubles>(bits); }

#endif

/// How many numbers, or truth values, a register holds.
template <class Register>
inline constexpr int lanes_in = int(sizeof(Register) / sizeof(double));

TALUS_HD inline FourMasks less(FourDoubles a, FourDoubles b) { return a < b; }
TALUS_HD inline FourMasks less_or_equal(FourDoubles a, FourDoubles b) { return a <= b; }
TALUS_HD inline FourMasks equal(FourDoubles a, FourDoubles b) { return a == b; }
TALUS_HD inline bool any_of(FourMasks m) { return sign_bits(m) != 0; }
TALUS_HD inline bool all_of(FourMasks m) { return sign_bits(m) == 15; }
TALUS_HD inline void set_number(FourDoubles& x, int i, double value) { x[i] = value; }
TALUS_HD inline void broadcast(double x, FourDoubles& all) { all = FourDoubles{x, x, x, x}; }
TALUS_HD inline void read(const double* column, FourDoubles& x) {
  x = *reinterpret_cast<const FourDoublesAnywhere*>(column);
}
TALUS_HD inline void write(FourDoubles x, double* column) { *reinterpret_cast<FourDoublesAnywhere*>(column) = x; }
/// Whole numbers as integers.
TALUS_HD inline void write_integers(FourDoubles x, int* column) {
  for (int i = 0; i < 4; ++i) column[i] = int(x[i]);
}
#if defined(__AVX2__) && !defined(__CUDACC__)
typedef long long FourWide __attribute__((vector_size(32)));
/// All bits of each of the first `count` lanes.
inline FourWide first_of_four(int count) { return FourWide{0, 1, 2, 3} < FourWide{count, count, count, count}; }
/// The first `count` numbers only; what is `beyond` them is the same in all lanes.
inline void read_first(const double* column, int count, double beyond, FourDoubles& x) {
  const FourWide first = first_of_four(count);
  const FourDoubles all{beyond, beyond, beyond, beyond};
  x = first ? __builtin_ia32_maskloadpd256(reinterpret_cast<const FourDoubles*>(column), first) : all;
}
inline void write_first(FourDoubles x, int count, double* column) {
  __builtin_ia32_maskstorepd256(reinterpret_cast<FourDoubles*>(column), first_of_four(count), x);
}
#else
TALUS_HD inline void read_first(const double* column, int count, double beyond, FourDoubles& x) {
  for (int i = 0; i < 4; ++i) x[i] = i < count ? column[i] : beyond;
}
TALUS_HD inline void write_first(FourDoubles x, int count, double* column) {
  for (int i = 0; i < 4 && i < count; ++i) column[i] = x[i];
}
#endif

}  // namespace talus

#if defined(__AVX512F__) && defined(__AVX512DQ__) && !defined(__CUDACC__)
#include "talus/base/eight_avx512.hpp"
#endif
#include "talus/base/two_registers.hpp"

namespace talus {

// Two of the widest registers are what a law updates at a time: while one waits for a division or a square root, the
// other goes on.
#if defined(__AVX512F__) && defined(__AVX512DQ__) && !defined(__CUDACC__)
using PackDoubles = Two<EightDoubles>;
#else
using EightDoubles = Two<FourDoubles>;
using PackDoubles = EightDoubles;
#endif

/// Asks for a line of memory that is needed soon, at any address.
TALUS_HD inline void fetch_ahead(const double* column) {
#if !defined(__CUDACC__)
  __builtin_prefetch(column);
#endif
}

/// Tells the processor that this thread waits for another one.
inline void relax_processor() {
#if defined(__x86_64__) && !defined(__CUDACC__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  asm volatile("yield");
#endif
}

/// Whether eight numbers are one register.
inline constexpr bool eight_in_a_register = lanes_in<PackDoubles> > lanes_in<EightDoubles>;
/// Numbers of the widest pack of any build: rows that are read pack by pack are as much longer.
inline constexpr int widest_pack = 16;

/// Whether `a * b + c` is one rounding on the target. Everywhere else the compiler is told not to contract
/// (`-ffp-contract=off`), so that scalar code and code for several particles at once give the same bits.
inline constexpr bool has_fma = TALUS_HAS_FMA;

/// What compiled this file, and the instructions it was allowed to use.
inline constexpr const char* compiler = TALUS_COMPILER;
inline constexpr const char* instructions = TALUS_INSTRUCTIONS;

}  // namespace talus
