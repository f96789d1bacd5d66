#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace accdec::study {

/// One axis of variation: a named quantity and the values it takes. The values are those of the task file, in its
/// units.
struct Variation {
  std::string name;               ///< name of its column; the first key unless the study gives a name
  std::vector<std::string> keys;  ///< dotted task keys that all take the same value, at least one
  std::vector<double> values;     ///< not empty; for a range the grid's points
  bool range = false;        ///< values came from a range: Latin hypercube draws between `values.front()` and `.back()`
  bool logarithmic = false;  ///< the range is even in the logarithm
};

enum class Sampling { grid, latin_hypercube };

struct Point {
  std::size_t index = 0;       ///< 0 .. size - 1
  std::size_t case_index = 0;  ///< into PointSet::cases
  std::vector<double> values;  ///< one per variation
};

/// The points of a study: every case with every combination of values (the first variation slowest), or with a seeded
/// Latin hypercube sample, the same for each case. Point i depends only on the plan, so any subset can be computed
/// anywhere.
class PointSet {
 public:
  /// @param samples  points per case of the hypercube; the grid does not use it
  /// @throws std::invalid_argument naming a variation without values, no case, two alike names, no samples, a size
  /// beyond 2^53.
  PointSet(std::vector<std::string> cases, std::vector<Variation> variations, Sampling sampling = Sampling::grid,
           std::size_t samples = 0, std::uint64_t seed = 0);

  std::size_t size() const { return cases_.size() * points_per_case_; }
  /// @throws std::out_of_range
  Point point(std::size_t index) const;

  const std::vector<std::string>& cases() const { return cases_; }
  const std::vector<Variation>& variations() const { return variations_; }

 private:
  std::vector<std::string> cases_;
  std::vector<Variation> variations_;
  std::size_t points_per_case_ = 1;
  std::vector<std::vector<double>> hypercube_;  ///< [variation][sample]
};

/// `count` values from `from` to `to`, both ends exact. If `logarithmic`, they are even in the logarithm, and both ends
/// must be > 0.
/// @throws std::invalid_argument if count is 0, an end is not finite, or a logarithmic end is not positive.
std::vector<double> spread(double from, double to, std::size_t count, bool logarithmic);

}  // namespace accdec::study
