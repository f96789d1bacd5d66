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

namespace {

struct BlockTimesSink {
  double before;  // samples
  std::size_t first;
  BlockTimes& times;
  void command(const AxisRow<0>&, const AxisRow<0>&, std::int64_t, const AxisRow<0>&) const {}
  void joint(std::size_t b, double time, std::int64_t rest) const {
    times.ends[b - first] = before + time;
    times.begins[b - first + 1] = before + time + static_cast<double>(rest);
  }
};

}  // namespace

BlockTimes block_times(const CommandTiming& timing, std::size_t first, std::size_t last) {
  BlockTimes times{std::vector<double>(last - first + 1, 0.0), std::vector<double>(last - first + 1, unlimited)};
  const double dwell = first == 0 ? static_cast<double>(timing.dwell_samples(timing.path().dwell_first)) : 0.0;
  BlockTimesSink sink{dwell, first, times};
  emit_commands<0>(timing, first, last, sink);
  return times;
}

}  // namespace accdec
