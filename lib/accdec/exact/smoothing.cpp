#include <algorithm>
#include <numeric>
#include <utility>

#include <accdec/exact/smoothing.hpp>

namespace accdec::exact {

Smoothing::Smoothing(const Machine& machine) : taps_(machine.prefilter_taps) {
  const double sum = std::accumulate(taps_.begin(), taps_.end(), 0.0);
  for (double& tap : taps_) tap /= sum;
  if (taps_.empty()) taps_ = {1.0};
}

double Smoothing::largest() const {
  return *std::max_element(taps_.begin(), taps_.end());
}

const Filter& Smoothing::command(const Filter& designed, std::optional<Filter>& made) const {
  if (none()) return designed;
  std::vector<double> taps(static_cast<std::size_t>(designed.order() + order()) + 1, 0.0);
  for (int i = 0; i <= designed.order(); ++i) {
    for (int j = 0; j <= order(); ++j)
      taps[static_cast<std::size_t>(i + j)] += designed.tap(i) * taps_[static_cast<std::size_t>(j)];
  }
  return made.emplace(std::move(taps));
}

void Smoothing::add_designed(std::span<const double> command, std::span<double> designed) const {
  for (std::size_t i = 0; i < designed.size(); ++i) {
    for (std::size_t j = 0; j < taps_.size(); ++j) designed[i] += taps_[j] * command[i + j];
  }
}

WeightedTaps::WeightedTaps(const Smoothing& smoothing, int order)
    : smoothing_(smoothing),
      designed_(static_cast<std::size_t>(order) + 1, 0.0),
      command_(smoothing.none() ? 0 : designed_.size() + static_cast<std::size_t>(smoothing.order()), 0.0),
      sums_(command().size() + 1, 0.0) {}

std::vector<double>& WeightedTaps::all() {
  const std::span<double> taps = command();
  double suffix = 0.0;
  for (std::size_t i = taps.size(); i-- > 0;) {
    suffix += sums_[i + 1];
    taps[i] += suffix;
  }
  if (!smoothing_.none()) smoothing_.add_designed(command_, designed_);
  return designed_;
}

}  // namespace accdec::exact
