#include <accdec/program/command_stream.hpp>

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
  for (const auto& [block, dwell] : path_.dwell) {
    if (block + 1 < blocks) samples += dwell_samples(dwell);  // one after the last move is no motion
  }
  return samples;
}

}  // namespace accdec
