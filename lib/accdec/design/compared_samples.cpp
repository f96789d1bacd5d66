#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <accdec/design/compared_samples.hpp>

namespace accdec {

ComparedSamples::ComparedSamples(const Filter& filter, const std::vector<int>& rows, const Eigen::MatrixXd& at,
                                 std::vector<BentPart> bent)
    : filter_(filter), rows_(rows) {
  split(std::move(bent));
  take(at);
}

void ComparedSamples::split(std::vector<BentPart> bent) {
  std::ranges::sort(bent, {}, &BentPart::after);
  constexpr int never = std::numeric_limits<int>::max();
  bent.push_back({never, never});
  std::size_t next = 0;
  for (const BentPart& part : bent) {
    const auto row_at = [&](int sample) {
      return static_cast<std::size_t>(std::lower_bound(rows_.begin(), rows_.end(), sample) - rows_.begin());
    };
    const std::size_t bends = part.after == never ? rows_.size() : row_at(part.after + 1);
    add(next, bends, true);
    next = std::max(next, bends);
    const std::size_t ends = row_at(part.before);
    add(next, ends, false);
    next = std::max(next, ends);
  }
}

void ComparedSamples::add(std::size_t first, std::size_t end, bool straight) {
  if (first >= end) return;
  Part part{.first = first, .end = end, .straight = straight && end - first > 2};
  if (part.straight) {
    const auto count = static_cast<double>(end - first);
    for (std::size_t r = first; r < end; ++r) part.middle += rows_[r] / count;
    for (std::size_t r = first; r < end; ++r) part.spread += (rows_[r] - part.middle) * (rows_[r] - part.middle);
    part.spread = std::sqrt(part.spread);
  }
  values_ += part.straight ? 2 : static_cast<Eigen::Index>(end - first);
  parts_.push_back(part);
}

void ComparedSamples::take(const Eigen::MatrixXd& at) {
  at_.resize(values_, at.cols());
  ones_ = Eigen::VectorXd::Ones(values_);
  beside_lines_ = Eigen::VectorXd::Zero(at.cols());
  Eigen::Index value = 0;
  for (const Part& part : parts_) {
    const auto first = static_cast<Eigen::Index>(part.first), count = static_cast<Eigen::Index>(part.end - part.first);
    if (!part.straight) {
      at_.middleRows(value, count) = at.middleRows(first, count);
      value += count;
      continue;
    }
    const double root = std::sqrt(static_cast<double>(count));
    ones_(value) = root, ones_(value + 1) = 0.0;
    for (Eigen::Index axis = 0; axis < at.cols(); ++axis) {
      const auto positions = at.col(axis).segment(first, count);
      const double mean = positions.mean();
      double moment = 0.0, squares = 0.0;
      for (Eigen::Index r = 0; r < count; ++r)
        moment += (rows_[part.first + static_cast<std::size_t>(r)] - part.middle) * (positions(r) - mean);
      const double slope = moment / (part.spread * part.spread);
      for (Eigen::Index r = 0; r < count; ++r) {
        const double line = mean + slope * (rows_[part.first + static_cast<std::size_t>(r)] - part.middle);
        squares += (positions(r) - line) * (positions(r) - line);
      }
      at_(value, axis) = root * mean, at_(value + 1, axis) = moment / part.spread;
      beside_lines_(axis) += squares;
    }
    value += 2;
  }
}

const Eigen::VectorXd& ComparedSamples::from(int first) {
  const auto [found, added] = columns_.try_emplace(first);
  Eigen::VectorXd& column = found->second;
  if (!added) return column;
  column.resize(values_);
  Eigen::Index value = 0;
  for (const Part& part : parts_) {
    if (part.straight) {
      const bool moves = rows_[part.end - 1] > first;
      const double root = std::sqrt(static_cast<double>(part.end - part.first));
      column(value++) = moves ? root * (part.middle - first - filter_.mean_delay()) : 0.0;
      column(value++) = moves ? part.spread : 0.0;
    } else {
      for (std::size_t r = part.first; r < part.end; ++r) column(value++) = filter_.elapsed_moment(rows_[r] - first);
    }
  }
  return column;
}

}  // namespace accdec
