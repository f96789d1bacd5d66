#include <algorithm>

#include <accdec/simulate.hpp>
#include <accdec/simulate/joint_distance.hpp>
#include <accdec/simulate/simd_lanes.hpp>

namespace accdec {
namespace {

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
ACCDEC_KERNEL void least_body(const double* const* position, std::size_t n, const double* points,
                              const JointWindow* joints, std::size_t count, double* squared) {
  using Lanes = typename Width::Lanes;
  constexpr std::int64_t lanes = lane_count<Width>;
  const double* of_axis[program_axis_count];
  for (std::size_t a = 0; a < (axes > 0 ? axes : n); ++a) of_axis[a] = position[a];
  for (std::size_t j = 0; j < count; ++j) {
    const JointWindow& joint = joints[j];
    const double* corner = points + (joint.block + 1) * (axes > 0 ? axes : n);
    const bool path = joint.path && joint.last > joint.first;
    const std::int64_t end = path ? joint.last : joint.last + 1;  // of the places that lanes may stand for
    Lanes least = Lanes{} + unlimited, d;
    double of_few = unlimited;
    for (std::int64_t k = joint.first; k < end; k += lanes) {
      // The last lanes of a window go back over places seen before, unless it is shorter than they are.
      const std::int64_t at = std::max(joint.first, std::min(k, end - lanes));
      if (path) {
        segments_squared<Width, axes>(reinterpret_cast<double*>(&d), of_axis, n, corner, at);
      } else {
        samples_squared<Width, axes>(reinterpret_cast<double*>(&d), of_axis, n, corner, at);
      }
      if (end - at < lanes) {
        for (std::int64_t l = 0; l < end - at; ++l) of_few = std::min(of_few, d[l]);
      } else {
        least = d < least ? d : least;
      }
    }
    for (std::int64_t l = 0; l < lanes; ++l) of_few = std::min(of_few, least[l]);
    squared[j] = of_few;
  }
}

template <class Width, std::size_t axes>
ACCDEC_KERNEL double path_body(const double* const* position, std::size_t n, const double* point, std::int64_t first,
                               std::int64_t last) {
  constexpr std::int64_t lanes = lane_count<Width>;
  alignas(64) double d[lanes];
  double least = unlimited;
  for (std::int64_t k = first; k < last; k += lanes) {
    segments_squared<Width, axes>(d, position, n, point, k);
    for (std::int64_t l = 0; l < lanes; ++l) least = k + l < last && d[l] < least ? d[l] : least;
  }
  return least;
}

using Least = void (*)(const double* const*, std::size_t, const double*, const JointWindow*, std::size_t, double*);

#define ACCDEC_LEAST(name, target, Width)                                                                         \
  target void name(const double* const* position, std::size_t n, const double* points, const JointWindow* joints, \
                   std::size_t count, double* squared) {                                                          \
    if (n == 2) return least_body<Width, 2>(position, n, points, joints, count, squared);                         \
    if (n == 3) return least_body<Width, 3>(position, n, points, joints, count, squared);                         \
    return least_body<Width, 0>(position, n, points, joints, count, squared);                                     \
  }

using Path = double (*)(const double* const*, std::size_t, const double*, std::int64_t, std::int64_t);

#define ACCDEC_PATH(name, target, Width)                                                                    \
  target double name(const double* const* position, std::size_t n, const double* point, std::int64_t first, \
                     std::int64_t last) {                                                                   \
    if (n == 2) return path_body<Width, 2>(position, n, point, first, last);                                \
    if (n == 3) return path_body<Width, 3>(position, n, point, first, last);                                \
    return path_body<Width, 0>(position, n, point, first, last);                                            \
  }
ACCDEC_LEAST(least_plain, , Two)
ACCDEC_PATH(path_plain, , Two)
#if defined(__x86_64__)
ACCDEC_LEAST(least_avx2, ACCDEC_TARGET_AVX2, Four)
ACCDEC_LEAST(least_avx512, ACCDEC_TARGET_AVX512, Eight)
ACCDEC_PATH(path_avx2, ACCDEC_TARGET_AVX2, Four)
ACCDEC_PATH(path_avx512, ACCDEC_TARGET_AVX512, Eight)
const Least least = for_this_processor<Least>(least_plain, least_avx2, least_avx512);
const Path path = for_this_processor<Path>(path_plain, path_avx2, path_avx512);
#else
constexpr Least least = least_plain;
constexpr Path path = path_plain;
#endif

}  // namespace

void least_squared(const double* const* position, std::size_t n, const double* points, const JointWindow* joints,
                   std::size_t count, double* squared) {
  least(position, n, points, joints, count, squared);
}

double path_squared(const double* const* position, std::size_t n, const double* point, std::int64_t first,
                    std::int64_t last) {
  return path(position, n, point, first, last);
}

}  // namespace accdec
