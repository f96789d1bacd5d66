#include "progress_bar.hpp"

#include <algorithm>
#include <cstdio>
#include <string>

#include <fmt/format.h>

namespace accdec::cli {
namespace {

std::string clock_text(double seconds) {
  const long s = static_cast<long>(seconds + 0.5);
  return s < 3600 ? fmt::format("{}:{:02}", s / 60, s % 60)
                  : fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
}

}  // namespace

void ProgressBar::operator()(const StudyProgress& p) {
  if (p.done < p.total && p.seconds - shown_ < 0.1) return;
  shown_ = p.seconds;
  const double share = static_cast<double>(p.done) / static_cast<double>(p.total),
               rate = static_cast<double>(p.done) / std::max(p.seconds, 1e-9);
  const auto filled = static_cast<std::size_t>(30.0 * share);
  std::fputs(
      fmt::format("\r[{}{}] {}/{}  {:.3g} {}/s  {} left  ", std::string(filled, '#'), std::string(30 - filled, '.'),
                  p.done, p.total, rate, unit_, clock_text(static_cast<double>(p.total - p.done) / rate))
          .c_str(),
      stderr);
  if (p.done == p.total) std::fputs("\n", stderr);
  std::fflush(stderr);
}

}  // namespace accdec::cli
