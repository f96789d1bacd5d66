#include <algorithm>

#include <accdec/simulate/motion_extremes.hpp>
#include <accdec/simulate/simd_lanes.hpp>

namespace accdec {
namespace {

/// largest = max(largest, value) lane by lane.
template <class Width>
ACCDEC_KERNEL void raise(typename Width::Lanes& largest, const typename Width::Lanes& value) {
  largest = value > largest ? value : largest;
}
template <class Width>
ACCDEC_KERNEL double largest_of(const typename Width::Lanes& lanes) {
  double largest = 0.0;
  for (int l = 0; l < lane_count<Width>; ++l) largest = std::max(largest, lanes[l]);
  return largest;
}

template <class Width>
ACCDEC_KERNEL void extremes_body(const double* v, const double* a, std::int64_t n, double m, double c, bool loads,
                                 MotionExtremes* result) {
  using Lanes = typename Width::Lanes;
  constexpr std::int64_t lanes = lane_count<Width>;
  Lanes velocity = {}, acceleration = {}, jerk = {}, force = {}, power = {}, regeneration = {};
  const Lanes zero = {};
  const auto take = [&](const double* vk, const double* ak, const double* before) __attribute__((always_inline)) {
    const Lanes speed = *reinterpret_cast<const Lanes*>(vk), by = *reinterpret_cast<const Lanes*>(ak);
    const Lanes change = by - *reinterpret_cast<const Lanes*>(before);
    raise<Width>(velocity, speed > zero ? speed : -speed);
    raise<Width>(acceleration, by > zero ? by : -by);
    raise<Width>(jerk, change > zero ? change : -change);
    if (loads) {
      const Lanes drive = m * by + c * speed, work = drive * speed;
      raise<Width>(force, drive > zero ? drive : -drive);
      raise<Width>(power, work);
      raise<Width>(regeneration, -work);
    }
  };
  std::int64_t k = 0;
  for (; k + lanes <= n; k += lanes) take(v + k, a + k, a + k - 1);
  if (k < n) {
    double rest_v[lanes] = {}, rest_a[lanes] = {}, rest_before[lanes] = {};
    for (std::int64_t i = k; i < n; ++i) {
      rest_v[i - k] = v[i];
      rest_a[i - k] = a[i];
      rest_before[i - k] = a[i - 1];
    }
    take(rest_v, rest_a, rest_before);
  }
  *result = {largest_of<Width>(velocity), largest_of<Width>(acceleration), largest_of<Width>(jerk),
             largest_of<Width>(force),    largest_of<Width>(power),        largest_of<Width>(regeneration)};
}

using Extremes = void (*)(const double*, const double*, std::int64_t, double, double, bool, MotionExtremes*);

void extremes_plain(const double* v, const double* a, std::int64_t n, double m, double c, bool loads,
                    MotionExtremes* result) {
  extremes_body<Two>(v, a, n, m, c, loads, result);
}
#if defined(__x86_64__)
ACCDEC_TARGET_AVX2 void extremes_avx2(const double* v, const double* a, std::int64_t n, double m, double c, bool loads,
                                      MotionExtremes* result) {
  extremes_body<Four>(v, a, n, m, c, loads, result);
}
ACCDEC_TARGET_AVX512 void extremes_avx512(const double* v, const double* a, std::int64_t n, double m, double c,
                                          bool loads, MotionExtremes* result) {
  extremes_body<Eight>(v, a, n, m, c, loads, result);
}
const Extremes extremes = for_this_processor<Extremes>(extremes_plain, extremes_avx2, extremes_avx512);
#else
constexpr Extremes extremes = extremes_plain;
#endif

}  // namespace

MotionExtremes motion_extremes(const double* v, const double* a, std::int64_t n, double m, double c, bool loads) {
  MotionExtremes result;
  extremes(v, a, n, m, c, loads, &result);
  return result;
}

}  // namespace accdec
