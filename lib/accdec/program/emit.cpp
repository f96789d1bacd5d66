#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include <accdec/program/report.hpp>

namespace accdec {

void emit_program(const ProgramResult& result, std::ostream& out) {
  const Toolpath& path = result.path;
  const std::size_t n = path.dimensions();
  const double period = result.sample_period;
  const CommandTiming timing(path, period, result.plan.delays);
  fmt::memory_buffer text;
  const auto put = std::back_inserter(text);
  const auto words = [&](const double* point) {
    for (std::size_t a = 0; a < n; ++a) fmt::format_to(put, " {}{:.6f}", program_axes[path.axes[a]], point[a] * 1e3);
  };
  if (result.legs.single()) {
    fmt::format_to(put, "(delays as dwells for a filter of {} taps at T = {:.6g} ms)\n", result.filter.order() + 1, period * 1e3);
  } else {
    fmt::format_to(put, "(delays as dwells for a filter a leg at T = {:.6g} ms)\n", period * 1e3);
  }
  fmt::format_to(put, "G21 G17 G90 G94\n");
  bool away = false;
  for (std::size_t a = 0; a < n; ++a) away = away || path.point(0)[a] != 0.0;
  if (away) {
    fmt::format_to(put, "(begins at");
    words(path.point(0));
    fmt::format_to(put, ")\n");
  }
  if (path.dwell_first > 0.0) fmt::format_to(put, "G4 P{:.6f}\n", static_cast<double>(timing.dwell_samples(path.dwell_first)) * period);

  std::size_t next_dwell = 0;
  double feed_written = 0.0;
  for (std::size_t run = 0; run < path.blocks();) {
    const std::size_t end = timing.run_end(run);
    const double length = timing.run_length(run, end);
    const double stretch = static_cast<double>(CommandTiming::run_samples(length)) / length;
    if (!result.legs.single() && (run == 0 || result.legs.index(run) != result.legs.index(run - 1))) {
      fmt::format_to(put, "(filter of {} taps)\n", result.legs.of(run).order() + 1);
    }
    for (std::size_t b = run; b <= end; ++b) {
      ProgramPoint from{}, to{};
      for (std::size_t a = 0; a < n; ++a) {
        from[path.axes[a]] = path.point(b)[a];
        to[path.axes[a]] = path.point(b + 1)[a];
      }
      // feed_duration at unit feed is the length that feeds count.
      const double feed = feed_duration(from, to, 1.0) / (path.duration[b] * stretch) * 60e3;
      fmt::format_to(put, "G1");
      words(path.point(b + 1));
      if (std::abs(feed - feed_written) > 1e-9 * feed) fmt::format_to(put, " F{:.9g}", feed);
      feed_written = feed;
      text.push_back('\n');
      if (text.size() > 60000) {
        out.write(text.data(), static_cast<std::streamsize>(text.size()));
        text.clear();
      }
    }
    std::int64_t rest = end + 1 < path.blocks() ? result.plan.delays[end] : 0;
    for (; next_dwell < path.dwell.size() && path.dwell[next_dwell].first <= end; ++next_dwell) {
      if (end + 1 < path.blocks()) rest += timing.dwell_samples(path.dwell[next_dwell].second);
    }
    if (rest > 0) fmt::format_to(put, "G4 P{:.9g}\n", static_cast<double>(rest) * period);
    run = end + 1;
  }
  fmt::format_to(put, "M2\n");
  out.write(text.data(), static_cast<std::streamsize>(text.size()));
}

}  // namespace accdec
