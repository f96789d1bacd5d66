#include <algorithm>

#include <accdec/simulate.hpp>
#include <accdec/simulate/joint_distance.hpp>
#include <accdec/simulate/simd_lanes.hpp>

namespace accdec {
namespace {

constexpr double far = 1e300;
constexpr std::int64_t places = 8;  // examined for every joint

/// @tparam axes  their number; 0: n
template <class Width, std::size_t axes>
ACCDEC_KERNEL void samples_squared(double* squared, const double* const* position, std::size_t n, const double* corner,
                                   std::int64_t k) {
  using Lanes = typename Width::Lanes;
  Lanes sum = {};
  for (std::size_t a = 0; a < (axes > 0 ? axes : n); ++a) {
    const Lanes d = *reinterpret_cast<const Lanes*>(position[a] + k) - corner[a];
    sum += d * d;
  }
  *reinterpret_cast<Lanes*>(squared) = sum;
}

/// Squared distances of the segments from sample k + i to k + i + 1.
template <class Width, std::size_t axes>
ACCDEC_KERNEL void segments_squared(double* squared, const double* const* position, std::size_t n, const double* corner,
                                    std::int64_t k) {
  using Lanes = typename Width::Lanes;
  const Lanes zero = {}, one = zero + 1.0;
  Lanes ab2 = zero + 1e-300, dot = {};
  for (std::size_t a = 0; a < (axes > 0 ? axes : n); ++a) {
    const Lanes p = *reinterpret_cast<const Lanes*>(position[a] + k);
    const Lanes d = *reinterpret_cast<const Lanes*>(position[a] + k + 1) - p;
    ab2 += d * d;
    dot += (corner[a] - p) * d;
  }
  Lanes t = dot / ab2;
  t = t > zero ? t : zero;
  t = t < one ? t : one;
  Lanes sum = {};
  for (std::size_t a = 0; a < (axes > 0 ? axes : n); ++a) {
    const Lanes p = *reinterpret_cast<const Lanes*>(position[a] + k);
    const Lanes d = *reinterpret_cast<const Lanes*>(position[a] + k + 1) - p;
    const Lanes x = p + t * d - corner[a];
    sum += x * x;
  }
  *reinterpret_cast<Lanes*>(squared) = sum;
}

template <class Width, std::size_t axes>
ACCDEC_KERNEL void nearest_body(const double* const* position, std::size_t n, const double* points,
                                const JointWindow* joints, std::size_t count, double* squared) {
  const double* of_axis[program_axis_count];
  for (std::size_t a = 0; a < (axes > 0 ? axes : n); ++a) of_axis[a] = position[a];
  for (std::size_t j = 0; j < count; ++j) {
    const JointWindow& joint = joints[j];
    const double* corner = points + (joint.block + 1) * (axes > 0 ? axes : n);
    const bool path = joint.path && joint.last > joint.first;
    const std::int64_t end = path ? joint.last - 1 : joint.last;  // last place a lane may stand for
    const std::int64_t k = std::max(joint.first, std::min(joint.guess - places / 2, end - (places - 1)));
    alignas(64) double d[places];
    for (std::int64_t i = 0; i < places; i += lane_count<Width>) {
      if (path) {
        segments_squared<Width, axes>(d + i, of_axis, n, corner, k + i);
      } else {
        samples_squared<Width, axes>(d + i, of_axis, n, corner, k + i);
      }
    }
    for (std::int64_t l = end - k + 1; l < places; ++l) d[l] = far;
    const double inner = std::min(std::min(std::min(d[1], d[2]), std::min(d[3], d[4])), std::min(d[5], d[6]));
    const bool outermost = (d[0] < inner && k > joint.first) || (d[7] < inner && k + places - 1 < end);
    squared[j] = outermost ? -1.0 : std::min(inner, std::min(d[0], d[7]));
  }
}

template <class Width, std::size_t axes>
ACCDEC_KERNEL double path_body(const double* const* position, std::size_t n, const double* point, std::int64_t first,
                               std::int64_t last) {
  constexpr std::int64_t lanes = lane_count<Width>;
  alignas(64) double d[lanes];
  double least = far;
  for (std::int64_t k = first; k < last; k += lanes) {
    segments_squared<Width, axes>(d, position, n, point, k);
    for (std::int64_t l = 0; l < lanes; ++l) least = k + l < last && d[l] < least ? d[l] : least;
  }
  return least;
}

using Nearest = void (*)(const double* const*, std::size_t, const double*, const JointWindow*, std::size_t, double*);

#define ACCDEC_NEAREST(name, target, Width)                                                                       \
  target void name(const double* const* position, std::size_t n, const double* points, const JointWindow* joints, \
                   std::size_t count, double* squared) {                                                          \
    if (n == 2) return nearest_body<Width, 2>(position, n, points, joints, count, squared);                       \
    if (n == 3) return nearest_body<Width, 3>(position, n, points, joints, count, squared);                       \
    return nearest_body<Width, 0>(position, n, points, joints, count, squared);                                   \
  }

using Path = double (*)(const double* const*, std::size_t, const double*, std::int64_t, std::int64_t);

#define ACCDEC_PATH(name, target, Width)                                                                    \
  target double name(const double* const* position, std::size_t n, const double* point, std::int64_t first, \
                     std::int64_t last) {                                                                   \
    if (n == 2) return path_body<Width, 2>(position, n, point, first, last);                                \
    if (n == 3) return path_body<Width, 3>(position, n, point, first, last);                                \
    return path_body<Width, 0>(position, n, point, first, last);                                            \
  }
ACCDEC_NEAREST(nearest_plain, , Two)
ACCDEC_PATH(path_plain, , Two)
#if defined(__x86_64__)
ACCDEC_NEAREST(nearest_avx2, ACCDEC_TARGET_AVX2, Four)
ACCDEC_NEAREST(nearest_avx512, ACCDEC_TARGET_AVX512, Eight)
ACCDEC_PATH(path_avx2, ACCDEC_TARGET_AVX2, Four)
ACCDEC_PATH(path_avx512, ACCDEC_TARGET_AVX512, Eight)
const Nearest nearest = for_this_processor<Nearest>(nearest_plain, nearest_avx2, nearest_avx512);
const Path path = for_this_processor<Path>(path_plain, path_avx2, path_avx512);
#else
constexpr Nearest nearest = nearest_plain;
constexpr Path path = path_plain;
#endif

}  // namespace

void nearest_squared(const double* const* position, std::size_t n, const double* points, const JointWindow* joints,
                     std::size_t count, double* squared) {
  nearest(position, n, points, joints, count, squared);
}

double path_squared(const double* const* position, std::size_t n, const double* point, std::int64_t first,
                    std::int64_t last) {
  return path(position, n, point, first, last);
}

}  // namespace accdec
