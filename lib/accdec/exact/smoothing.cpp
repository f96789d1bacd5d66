#include <algorithm>
#include <utility>

#include <accdec/exact/smoothing.hpp>

namespace accdec::exact {

Smoothing::Smoothing(Response response) : response_(std::move(response)), taps_(response_.motion(Filter({1.0}))) {}

/// The smoothing does not depend on the period, which only servos need.
Smoothing Smoothing::of_command(const Machine& machine) {
  Machine smoothing;
  smoothing.prefilter_taps = machine.prefilter_taps;
  return of_motion(smoothing, 1.0);
}

Smoothing Smoothing::of_motion(const Machine& machine, double period) {
  return Smoothing(Response(machine, period));
}

double Smoothing::largest(int first, int last) const {
  double most = 0.0;
  for (int j = std::max(first, 0); j <= std::min(last, order()); ++j) most = std::max(most, taps_.tap(j));
  return most;
}

const Filter& Smoothing::behind(const Filter& designed, std::optional<Filter>& made) const {
  return none() ? designed : made.emplace(response_.motion(designed));
}

void Smoothing::add_designed(std::span<const double> command, std::span<double> designed) const {
  for (std::size_t i = 0; i < designed.size(); ++i) {
    for (std::size_t j = 0; j < taps_.taps().size(); ++j) designed[i] += taps_.taps()[j] * command[i + j];
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
