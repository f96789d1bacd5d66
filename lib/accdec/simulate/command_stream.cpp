#include <accdec/simulate/command_stream.hpp>

namespace accdec {

std::int64_t CommandTiming::command_samples() const {
  std::int64_t samples = dwell_samples(path_.dwell_first);
  const std::size_t blocks = path_.blocks();
  for (std::size_t run = 0; run < blocks;) {
    const std::size_t end = run_end(run);
    samples += run_samples(run_length(run, end));
    if (end + 1 < blocks) samples += delays_[end];
    run = end + 1;
  }
  for (const auto& block_dwell : path_.dwell) samples += dwell_samples(block_dwell.second);
  return samples;
}

std::int64_t CommandTiming::dwell_last() const {
  std::int64_t samples = 0;
  for (auto last = path_.dwell.rbegin(); last != path_.dwell.rend() && last->first + 1 == path_.blocks(); ++last) {
    samples += dwell_samples(last->second);
  }
  return samples;
}

}  // namespace accdec
