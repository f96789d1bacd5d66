#include <cmath>

#include <accdec/exact/tableau_loops.hpp>

namespace accdec::exact {
namespace {

// The same source is compiled twice: for every processor, and for those with AVX2.
#define ACCDEC_INLINE [[gnu::always_inline]] inline

ACCDEC_INLINE void add(double* __restrict to, const double* __restrict from, double factor, std::size_t size) {
  for (std::size_t j = 0; j < size; ++j) to[j] += factor * from[j];
}

/// Adds up in four parallel sums.
template <class Term>
ACCDEC_INLINE double sum(std::size_t size, Term term) {
  double sums[4] = {0.0, 0.0, 0.0, 0.0};
  for (std::size_t j = 0; j < size; j += 4) {
    for (std::size_t l = 0; l < 4; ++l) sums[l] += term(j + l);
  }
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

ACCDEC_INLINE double sum_products(const double* a, const double* b, std::size_t size) {
  return sum(size, [=](std::size_t j) { return a[j] * b[j]; });
}

ACCDEC_INLINE double sum_squares(const double* weights, const double* x, std::size_t size) {
  return sum(size, [=](std::size_t j) { return weights[j] * x[j] * x[j]; });
}

ACCDEC_INLINE void add_to_rows(double* rows, std::size_t count, std::size_t size, const double* pivot_row,
                               std::size_t position, int but) {
  for (std::size_t r = 0; r < count; ++r) {
    double* const row = rows + r * size;
    const double factor = row[position];
    if (factor == 0.0 || static_cast<int>(r) == but) continue;
    row[position] = 0.0;
    if (std::abs(factor) >= 1e-14) add(row, pivot_row, factor, size);
  }
}

#if defined(__x86_64__)
#define ACCDEC_AVX2 __attribute__((target("avx2")))

const bool has_avx2 = __builtin_cpu_supports("avx2");

ACCDEC_AVX2 void add_avx2(double* to, const double* from, double factor, std::size_t size) {
  add(to, from, factor, size);
}
ACCDEC_AVX2 double sum_products_avx2(const double* a, const double* b, std::size_t size) {
  return sum_products(a, b, size);
}
ACCDEC_AVX2 double sum_squares_avx2(const double* weights, const double* x, std::size_t size) {
  return sum_squares(weights, x, size);
}
ACCDEC_AVX2 void add_to_rows_avx2(double* rows, std::size_t count, std::size_t size, const double* pivot_row,
                                  std::size_t position, int but) {
  add_to_rows(rows, count, size, pivot_row, position, but);
}
#define ACCDEC_BEST_OF(loop, ...) return has_avx2 ? loop##_avx2(__VA_ARGS__) : loop(__VA_ARGS__)
#else
#define ACCDEC_BEST_OF(loop, ...) return loop(__VA_ARGS__)
#endif

}  // namespace

void add_multiple(double* to, const double* from, double factor, std::size_t size) {
  ACCDEC_BEST_OF(add, to, from, factor, size);
}

double dot(const double* a, const double* b, std::size_t size) {
  ACCDEC_BEST_OF(sum_products, a, b, size);
}

double sum_of_squares(const double* weights, const double* x, std::size_t size) {
  ACCDEC_BEST_OF(sum_squares, weights, x, size);
}

void add_multiples_of_row(double* rows, std::size_t count, std::size_t size, const double* pivot_row,
                          std::size_t position, int but) {
  ACCDEC_BEST_OF(add_to_rows, rows, count, size, pivot_row, position, but);
}

}  // namespace accdec::exact
