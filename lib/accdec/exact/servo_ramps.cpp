#include <accdec/exact/servo_ramps.hpp>
#include <accdec/machine/response.hpp>

namespace accdec::exact {

ServoRamps::ServoRamps(const Task& task) : before_(1, 0.0), after_(1, 0.0) {
  const Response response(task.machine, task.sample_period);
  if (response.ideal()) return;
  // The response itself: that of a filter of one tap.
  const Filter taps = response.motion(Filter({1.0}));
  mean_ = taps.mean_delay();
  before_.clear(), after_.clear();
  for (int x = 0; x <= taps.order(); ++x) {
    before_.push_back(taps.elapsed_moment(x));
    after_.push_back(taps.remaining_moment(x));
  }
}

}  // namespace accdec::exact
