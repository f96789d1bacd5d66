#pragma once

#include <vector>

#include <accdec/design/decay_fit.hpp>

namespace accdec {

/// Jolts at which the energy of a period rises: the energy of the `window` behind is much larger than that before it.
std::vector<Stretch> jolts_by_rise(const std::vector<double>& signal, std::size_t window);

/// Jolts at which the signal is no sum of damped vibrations: from the first to the last sample of each. Windows that
/// hold no jolt are fitted to the noise. @param part  of a window's energy that counts as well as noise, as the poles
/// are not exact
std::vector<Stretch> jolts_by_fit(const std::vector<double>& signal, const std::vector<Decay>& poles, double period,
                                  double part);

/// The stretches between jolts, the first samples of each left out.
std::vector<Stretch> between(const std::vector<Stretch>& jolts, std::size_t samples, std::size_t window);

/// Leaves out the ends of stretches that are as quiet as the quietest parts of the signal. If there are more samples
/// than `most`, the quietest stretches are left out, too. @param longest  of a stretch
void shorten(std::vector<Stretch>& stretches, const std::vector<double>& values, std::size_t window,
             std::size_t longest, std::size_t most);

}  // namespace accdec
