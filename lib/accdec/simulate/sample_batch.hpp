#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include <accdec/simulate.hpp>
#include <accdec/simulate/joint_distance.hpp>

namespace accdec {

/// Samples 1 .. count() of a motion that are looked at together, and the last one before them, sample 0. Their places
/// on the path do not fall.
class SampleBatch {
 public:
  /// At rest where leg `first` begins.
  SampleBatch(const Toolpath& path, std::size_t first)
      : positions_(path.dimensions() * row),
        velocities_(path.dimensions() * row),
        accelerations_(path.dimensions() * row),
        firsts_(most + 3, 2 * static_cast<std::int64_t>(first)),
        lasts_(most + 1, firsts_.front()) {
    for (std::size_t a = 0; a < path.dimensions(); ++a) {
      rows_.push_back(positions_.data() + a * row);
      positions_[a * row] = path.point(first)[a];
    }
  }
  SampleBatch(const SampleBatch&) = delete;
  SampleBatch& operator=(const SampleBatch&) = delete;

  std::int64_t count() const { return count_; }
  bool takes(std::int64_t place_first, std::int64_t place_last) const {
    return count_ < most && place_first >= firsts_[at(count_) + 2] && place_last >= lasts_[at(count_)];
  }
  void add(const double* position, std::int64_t place_first, std::int64_t place_last) {
    ++count_;
    for (std::size_t a = 0; a < rows_.size(); ++a) positions_[a * row + at(count_)] = position[a];
    firsts_[at(count_) + 2] = place_first;
    lasts_[at(count_)] = place_last;
  }
  /// Further samples on the same place, written behind the last one and then added.
  std::int64_t room() const { return most - count_; }
  std::array<double*, program_axis_count> rows_behind() {
    std::array<double*, program_axis_count> rows{};
    for (std::size_t a = 0; a < rows_.size(); ++a) rows[a] = positions_.data() + a * row + at(count_) + 1;
    return rows;
  }
  std::int64_t* firsts_behind() { return firsts_.data() + count_ + 3; }
  void add_run(std::int64_t count, std::int64_t place_last) {
    std::fill_n(lasts_.begin() + count_ + 1, count, place_last);
    count_ += count;
  }
  /// Makes velocities and accelerations. @param rate  of samples, 1/s
  void difference(double rate) {
    for (std::size_t a = 0; a < rows_.size(); ++a) {
      const double* const x = rows_[a];
      double* const v = velocities_.data() + a * row;
      double* const by = accelerations_.data() + a * row;
      for (std::int64_t i = 1; i <= count_; ++i) v[i] = (x[i] - x[i - 1]) * rate;
      for (std::int64_t i = 1; i <= count_; ++i) by[i] = (v[i] - v[i - 1]) * rate;
    }
  }
  /// The last sample becomes sample 0.
  void end() {
    for (std::vector<double>* values : {&velocities_, &accelerations_}) {
      for (std::size_t a = 0; a < rows_.size(); ++a) (*values)[a * row] = (*values)[a * row + at(count_)];
    }
    std::copy_n(firsts_.begin() + count_, 3, firsts_.begin());
    lasts_[0] = lasts_[at(count_)];
    end_steady();
  }
  /// The same after samples that go on as before: velocities and places stay.
  void end_steady() {
    for (std::size_t a = 0; a < rows_.size(); ++a) positions_[a * row] = positions_[a * row + at(count_)];
    count_ = 0;
  }

  /// Rows of the axes by sample, m. As many more values as path_squared may read are readable.
  const double* const* positions() const { return rows_.data(); }
  const double* velocity(std::size_t axis) const { return velocities_.data() + axis * row; }
  const double* acceleration(std::size_t axis) const { return accelerations_.data() + axis * row; }
  /// The first place of sample i - earlier, earlier = 0 .. 3.
  std::int64_t place_first(std::int64_t i, int earlier = 0) const { return firsts_[at(i) + 2 - at(earlier)]; }
  std::int64_t place_last(std::int64_t i) const { return lasts_[at(i)]; }

 private:
  static constexpr std::int64_t most = 256;
  static constexpr std::size_t row = most + 1 + nearest_margin;
  static std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

  std::vector<double> positions_, velocities_, accelerations_;  // a row an axis
  std::vector<const double*> rows_;                             // of the positions
  std::vector<std::int64_t> firsts_, lasts_;                    // places; those of firsts_ begin with sample -2
  std::int64_t count_ = 0;
};

}  // namespace accdec
