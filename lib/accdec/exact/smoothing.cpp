#include <algorithm>

#include <accdec/exact/smoothing.hpp>

namespace accdec::exact {
namespace {

/// The smoothing does not depend on the period, which only servos need.
Response without_servos(const Machine& machine) {
  Machine smoothing;
  smoothing.prefilter_taps = machine.prefilter_taps;
  return {smoothing, 1.0};
}

}  // namespace

Smoothing::Smoothing(const Machine& machine) : response_(without_servos(machine)), taps_(response_.prefilter()) {}

double Smoothing::largest() const {
  return *std::max_element(taps_.begin(), taps_.end());
}

const Filter& Smoothing::command(const Filter& designed, std::optional<Filter>& made) const {
  return none() ? designed : made.emplace(response_.command(designed));
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
