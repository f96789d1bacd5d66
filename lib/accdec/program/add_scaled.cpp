#include <accdec/program/add_scaled.hpp>

#if defined(__x86_64__) && defined(__GNUC__)
#include <immintrin.h>
#endif

namespace accdec {
namespace {

void add_scaled_plain(double* y, double a, const double* x, std::int64_t n) {
  for (std::int64_t i = 0; i < n; ++i) y[i] += a * x[i];
}

void add_scaled4_plain(double* y, const double* a, const double* x, std::int64_t n) {
  for (std::int64_t i = 0; i < n; ++i) y[i] += a[0] * x[i] + a[1] * x[i - 1] + a[2] * x[i - 2] + a[3] * x[i - 3];
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
__attribute__((target("avx2,fma"))) void add_scaled4_avx2(double* y, const double* a, const double* x, std::int64_t n) {
  const __m256d a0 = _mm256_set1_pd(a[0]), a1 = _mm256_set1_pd(a[1]), a2 = _mm256_set1_pd(a[2]), a3 = _mm256_set1_pd(a[3]);
  for (std::int64_t i = 0; i < n; i += 4) {
    __m256d sum = _mm256_fmadd_pd(a0, _mm256_loadu_pd(x + i), _mm256_loadu_pd(y + i));
    const __m256d other = _mm256_mul_pd(a2, _mm256_loadu_pd(x + i - 2));
    sum = _mm256_fmadd_pd(a1, _mm256_loadu_pd(x + i - 1), sum);
    _mm256_storeu_pd(y + i, _mm256_add_pd(sum, _mm256_fmadd_pd(a3, _mm256_loadu_pd(x + i - 3), other)));
  }
}
using Kernel = void (*)(double*, double, const double*, std::int64_t);
const Kernel kernel =
    __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") ? add_scaled_avx2 : add_scaled_plain;
using Kernel4 = void (*)(double*, const double*, const double*, std::int64_t);
const Kernel4 kernel4 =
    __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") ? add_scaled4_avx2 : add_scaled4_plain;
#endif

}  // namespace

void add_scaled(double* y, double a, const double* x, std::int64_t n) {
#if defined(__x86_64__) && defined(__GNUC__)
  kernel(y, a, x, n);
#else
  add_scaled_plain(y, a, x, n);
#endif
}

void add_scaled4(double* y, const double* a, const double* x, std::int64_t n) {
#if defined(__x86_64__) && defined(__GNUC__)
  kernel4(y, a, x, n);
#else
  add_scaled4_plain(y, a, x, n);
#endif
}

}  // namespace accdec
