#pragma once

#include <cstdint>

namespace accdec {

/// Two, four or eight doubles processed in parallel: GCC's and Clang's vector types, as wide as the registers of an
/// instruction set. They are never passed or returned by value, because that depends on the instruction set. They are
/// members of their own types, because a template argument loses its attributes.
struct Two {
  typedef double Lanes
      __attribute__((vector_size(16), aligned(8), may_alias));  // NOLINT: an alias cannot have these attributes
};
struct Four {
  typedef double Lanes __attribute__((vector_size(32), aligned(8), may_alias));  // NOLINT
};
struct Eight {
  typedef double Lanes __attribute__((vector_size(64), aligned(8), may_alias));  // NOLINT
};
template <class Width>
inline constexpr std::int64_t lane_count = sizeof(typename Width::Lanes) / sizeof(double);

// The body of a kernel is a template of its width, always inlined, and compiled for each instruction set by a function
// that does nothing but call it.
#define ACCDEC_KERNEL [[gnu::always_inline]] inline
#if defined(__x86_64__)
#define ACCDEC_TARGET_AVX512 __attribute__((target("avx512f,avx512dq,avx2,fma")))
#define ACCDEC_TARGET_AVX2 __attribute__((target("avx2,fma")))

/// The best of three versions of a kernel that this processor can run.
template <class Function>
Function for_this_processor(Function plain, Function avx2, Function avx512) {
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq")) return avx512;
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return avx2;
  return plain;
}
#endif

}  // namespace accdec
