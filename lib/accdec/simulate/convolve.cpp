#include <accdec/simulate/convolve.hpp>
#include <accdec/simulate/simd_lanes.hpp>

namespace accdec {
namespace {

template <class Width>
ACCDEC_KERNEL void add_scaled_body(double* y, double a, const double* x, std::int64_t n) {
  using Lanes = typename Width::Lanes;
  constexpr std::int64_t lanes = lane_count<Width>;
  for (std::int64_t i = 0; i < n; i += lanes) {
    *reinterpret_cast<Lanes*>(y + i) += a * *reinterpret_cast<const Lanes*>(x + i);
  }
}

/// @tparam rows  of lanes full of sums that are kept in registers while the taps go by
template <class Width, int rows = 8>
ACCDEC_KERNEL void add_convolved_body(double* y, const double* x, std::int64_t n, const double* taps,
                                      std::int64_t count) {
  using Lanes = typename Width::Lanes;
  constexpr std::int64_t lanes = lane_count<Width>;
  static_assert(rows * lanes <= convolve_margin);
  for (std::int64_t j = 0; j < n; j += rows * lanes) {
    Lanes sum[rows];
    for (int r = 0; r < rows; ++r) sum[r] = *reinterpret_cast<const Lanes*>(y + j + r * lanes);
    for (std::int64_t i = 0; i < count; ++i) {
      const double* at = x + j - i;
      const double tap = taps[i];
      for (int r = 0; r < rows; ++r) sum[r] += tap * *reinterpret_cast<const Lanes*>(at + r * lanes);
    }
    for (int r = 0; r < rows; ++r) *reinterpret_cast<Lanes*>(y + j + r * lanes) = sum[r];
  }
}

template <class Width>
ACCDEC_KERNEL void find_changes_body(const double* u, std::int64_t n, double* change, std::uint8_t* changes) {
  using Lanes = typename Width::Lanes;
  constexpr std::int64_t lanes = lane_count<Width>;
  const Lanes zero = {};
  Lanes numbers = {};
  for (int l = 0; l < lanes; ++l) numbers[l] = l;
  for (std::int64_t k = 0; k < n; k += change_window) {
    Lanes count = {};
    for (std::int64_t i = k; i < k + change_window; i += lanes) {
      const Lanes left = numbers + static_cast<double>(i - n);
      Lanes by = *reinterpret_cast<const Lanes*>(u + i) - *reinterpret_cast<const Lanes*>(u + i - 1);
      by = left < zero ? by : zero;
      count += by != zero ? zero + 1.0 : zero;
      *reinterpret_cast<Lanes*>(change + i) = by;
    }
    double sum = 0.0;
    for (int l = 0; l < lanes; ++l) sum += count[l];
    changes[k / change_window] = static_cast<std::uint8_t>(sum);
  }
}

using Scale = void (*)(double*, double, const double*, std::int64_t);
using Convolve = void (*)(double*, const double*, std::int64_t, const double*, std::int64_t);
using Find = void (*)(const double*, std::int64_t, double*, std::uint8_t*);

void scale_plain(double* y, double a, const double* x, std::int64_t n) {
  add_scaled_body<Two>(y, a, x, n);
}
void convolve_plain(double* y, const double* x, std::int64_t n, const double* taps, std::int64_t count) {
  add_convolved_body<Two>(y, x, n, taps, count);
}
void find_plain(const double* u, std::int64_t n, double* change, std::uint8_t* changes) {
  find_changes_body<Two>(u, n, change, changes);
}
#if defined(__x86_64__)
ACCDEC_TARGET_AVX2 void scale_avx2(double* y, double a, const double* x, std::int64_t n) {
  add_scaled_body<Four>(y, a, x, n);
}
ACCDEC_TARGET_AVX2 void convolve_avx2(double* y, const double* x, std::int64_t n, const double* taps,
                                      std::int64_t count) {
  add_convolved_body<Four>(y, x, n, taps, count);
}
ACCDEC_TARGET_AVX512 void scale_avx512(double* y, double a, const double* x, std::int64_t n) {
  add_scaled_body<Eight>(y, a, x, n);
}
ACCDEC_TARGET_AVX512 void convolve_avx512(double* y, const double* x, std::int64_t n, const double* taps,
                                          std::int64_t count) {
  add_convolved_body<Eight>(y, x, n, taps, count);
}
ACCDEC_TARGET_AVX2 void find_avx2(const double* u, std::int64_t n, double* change, std::uint8_t* changes) {
  find_changes_body<Four>(u, n, change, changes);
}
ACCDEC_TARGET_AVX512 void find_avx512(const double* u, std::int64_t n, double* change, std::uint8_t* changes) {
  find_changes_body<Eight>(u, n, change, changes);
}
const Find find = for_this_processor<Find>(find_plain, find_avx2, find_avx512);
const Scale scale = for_this_processor<Scale>(scale_plain, scale_avx2, scale_avx512);
const Convolve convolve = for_this_processor<Convolve>(convolve_plain, convolve_avx2, convolve_avx512);
#else
constexpr Find find = find_plain;
constexpr Scale scale = scale_plain;
constexpr Convolve convolve = convolve_plain;
#endif

}  // namespace

void add_scaled(double* y, double a, const double* x, std::int64_t n) {
  scale(y, a, x, n);
}

void find_changes(const double* u, std::int64_t n, double* change, std::uint8_t* changes) {
  find(u, n, change, changes);
}

void add_convolved(double* y, const double* x, std::int64_t n, const double* taps, std::int64_t count) {
  convolve(y, x, n, taps, count);
}

}  // namespace accdec
