#include <accdec/program/add_scaled.hpp>

#if defined(__x86_64__) && defined(__GNUC__)
#include <immintrin.h>
#endif

namespace accdec {
namespace {

void add_scaled_plain(double* y, double a, const double* x, std::int64_t n) {
  for (std::int64_t i = 0; i < n; ++i) y[i] += a * x[i];
}

#if defined(__x86_64__) && defined(__GNUC__)
__attribute__((target("avx2,fma"))) void add_scaled_avx2(double* y, double a, const double* x, std::int64_t n) {
  const __m256d factor = _mm256_set1_pd(a);
  std::int64_t i = 0;
  for (; i + 4 <= n; i += 4) {
    _mm256_storeu_pd(y + i, _mm256_fmadd_pd(factor, _mm256_loadu_pd(x + i), _mm256_loadu_pd(y + i)));
  }
  for (; i < n; ++i) y[i] += a * x[i];
}
using Kernel = void (*)(double*, double, const double*, std::int64_t);
const Kernel kernel =
    __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") ? add_scaled_avx2 : add_scaled_plain;
#endif

}  // namespace

void add_scaled(double* y, double a, const double* x, std::int64_t n) {
#if defined(__x86_64__) && defined(__GNUC__)
  kernel(y, a, x, n);
#else
  add_scaled_plain(y, a, x, n);
#endif
}

}  // namespace accdec
