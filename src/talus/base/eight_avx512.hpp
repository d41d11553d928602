#pragma once
/// Eight numbers in one register of AVX-512, with the results of two registers of four (two_registers.hpp).
/// `portability.hpp` includes this file where the target has AVX-512, and documents each function.

#include <immintrin.h>

#include "talus/base/portability.hpp"

namespace talus {

typedef double EightDoubles __attribute__((vector_size(64)));
typedef unsigned long EightBits __attribute__((vector_size(64)));
typedef double EightDoublesAnywhere __attribute__((vector_size(64), aligned(8), may_alias));

/// A mask with one bit for each lane.
struct EightMasks {
  __mmask8 bits;

  bool operator[](int i) const { return bits >> i & 1; }
  friend EightMasks operator&(EightMasks a, EightMasks b) { return {_kand_mask8(a.bits, b.bits)}; }
  friend EightMasks operator|(EightMasks a, EightMasks b) { return {_kor_mask8(a.bits, b.bits)}; }
  friend EightMasks operator~(EightMasks a) { return {_knot_mask8(a.bits)}; }
};
template <>
inline constexpr int lanes_in<EightMasks> = 8;
inline constexpr __mmask8 all_eight = 0xff;

inline EightMasks less(EightDoubles a, EightDoubles b) { return {_mm512_cmp_pd_mask(a, b, _CMP_LT_OS)}; }
inline EightMasks less_or_equal(EightDoubles a, EightDoubles b) { return {_mm512_cmp_pd_mask(a, b, _CMP_LE_OS)}; }
inline EightMasks equal(EightDoubles a, EightDoubles b) { return {_mm512_cmp_pd_mask(a, b, _CMP_EQ_OQ)}; }
inline bool any_of(EightMasks m) { return m.bits != 0; }
inline bool all_of(EightMasks m) { return m.bits == all_eight; }

inline FourDoubles low_half(EightDoubles x) { return __builtin_shufflevector(x, x, 0, 1, 2, 3); }
inline FourDoubles high_half(EightDoubles x) { return __builtin_shufflevector(x, x, 4, 5, 6, 7); }
inline void join(FourDoubles low, FourDoubles high, EightDoubles& both) {
  both = __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7);
}
inline void set_number(EightDoubles& x, int i, double value) { x[i] = value; }
inline EightDoubles blend(EightMasks m, EightDoubles a, EightDoubles b) { return _mm512_mask_blend_pd(m.bits, b, a); }
inline EightDoubles fused_multiply_add(EightDoubles a, EightDoubles b, EightDoubles c) {
  return _mm512_fmadd_pd(a, b, c);
}
// Masked forms with all lanes set: GCC 12 warns of uninitialised values in the forms without a mask.
inline EightDoubles square_roots(EightDoubles x) { return _mm512_mask_sqrt_pd(x, all_eight, x); }
inline EightDoubles floors(EightDoubles x) { return _mm512_mask_floor_pd(x, all_eight, x); }
inline EightDoubles magnitudes(EightDoubles x) { return _mm512_mask_abs_pd(x, all_eight, x); }
inline EightDoubles larger(EightDoubles a, EightDoubles b) { return _mm512_mask_max_pd(a, all_eight, b, a); }
inline EightDoubles smaller(EightDoubles a, EightDoubles b) { return _mm512_mask_min_pd(a, all_eight, b, a); }
inline EightBits bits_of(EightDoubles x) { return reinterpret_cast<EightBits>(x); }
inline EightDoubles doubles_of(EightBits bits) { return reinterpret_cast<EightDoubles>(bits); }

inline void broadcast(double x, EightDoubles& all) { all = _mm512_set1_pd(x); }
inline void read(const double* column, EightDoubles& x) { x = *reinterpret_cast<const EightDoublesAnywhere*>(column); }
inline void write(EightDoubles x, double* column) { *reinterpret_cast<EightDoublesAnywhere*>(column) = x; }
inline void write_integers(EightDoubles x, int* column) {
  _mm256_mask_storeu_epi32(column, all_eight, _mm512_maskz_cvttpd_epi32(all_eight, x));
}
/// A bit for each of the first `count` lanes.
inline __mmask8 first_lanes(int count) { return count >= 8 ? all_eight : __mmask8(count > 0 ? (1 << count) - 1 : 0); }
inline void read_first(const double* column, int count, double beyond, EightDoubles& x) {
  x = _mm512_mask_loadu_pd(_mm512_set1_pd(beyond), first_lanes(count), column);
}
inline void write_first(EightDoubles x, int count, double* column) {
  _mm512_mask_storeu_pd(column, first_lanes(count), x);
}

inline void to_fours(EightDoubles& a, EightDoubles& b, EightDoubles& c, EightDoubles& d) {
  const EightDoubles ab = __builtin_shufflevector(a, b, 0, 8, 1, 9, 2, 10, 3, 11);
  const EightDoubles ab_behind = __builtin_shufflevector(a, b, 4, 12, 5, 13, 6, 14, 7, 15);
  const EightDoubles cd = __builtin_shufflevector(c, d, 0, 8, 1, 9, 2, 10, 3, 11);
  const EightDoubles cd_behind = __builtin_shufflevector(c, d, 4, 12, 5, 13, 6, 14, 7, 15);
  a = __builtin_shufflevector(ab, cd, 0, 1, 8, 9, 2, 3, 10, 11);
  b = __builtin_shufflevector(ab, cd, 4, 5, 12, 13, 6, 7, 14, 15);
  c = __builtin_shufflevector(ab_behind, cd_behind, 0, 1, 8, 9, 2, 3, 10, 11);
  d = __builtin_shufflevector(ab_behind, cd_behind, 4, 5, 12, 13, 6, 7, 14, 15);
}
inline void from_fours(EightDoubles& a, EightDoubles& b, EightDoubles& c, EightDoubles& d) {
  const EightDoubles ab = __builtin_shufflevector(a, b, 0, 4, 8, 12, 1, 5, 9, 13);
  const EightDoubles ab_behind = __builtin_shufflevector(a, b, 2, 6, 10, 14, 3, 7, 11, 15);
  const EightDoubles cd = __builtin_shufflevector(c, d, 0, 4, 8, 12, 1, 5, 9, 13);
  const EightDoubles cd_behind = __builtin_shufflevector(c, d, 2, 6, 10, 14, 3, 7, 11, 15);
  a = __builtin_shufflevector(ab, cd, 0, 1, 2, 3, 8, 9, 10, 11);
  b = __builtin_shufflevector(ab, cd, 4, 5, 6, 7, 12, 13, 14, 15);
  c = __builtin_shufflevector(ab_behind, cd_behind, 0, 1, 2, 3, 8, 9, 10, 11);
  d = __builtin_shufflevector(ab_behind, cd_behind, 4, 5, 6, 7, 12, 13, 14, 15);
}

}  // namespace talus
