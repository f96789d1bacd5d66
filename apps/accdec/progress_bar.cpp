#include "progress_bar.hpp"

#include <algorithm>
#include <string>

#include <fmt/format.h>

namespace accdec::cli {

ProgressBar::ProgressBar(const char* unit)
    : unit_(unit), line_(std::make_shared<StatusLine>(false, StatusLine::Lines::none)) {}

void ProgressBar::operator()(const StudyProgress& p) {
  if (p.done < p.total && p.seconds - shown_ < 0.1) return;
  shown_ = p.seconds;
  const double share = static_cast<double>(p.done) / static_cast<double>(p.total),
               rate = static_cast<double>(p.done) / std::max(p.seconds, 1e-9);
  const auto filled = static_cast<std::size_t>(30.0 * share);
  line_->tell(fmt::format("[{}{}] {}/{}  {:.3g} {}/s  {} left", std::string(filled, '#'), std::string(30 - filled, '.'),
                          p.done, p.total, rate, unit_, clock_text(static_cast<double>(p.total - p.done) / rate)));
}

}  // namespace accdec::cli
