#include "progress_bar.hpp"

#include <algorithm>
#include <cstdio>
#include <string>

#include <fmt/format.h>

#include "terminal.hpp"

namespace accdec::cli {

ProgressBar::ProgressBar(const char* unit)
    : unit_(unit), terminal_(is_terminal(stderr)), line_(std::make_shared<StatusLine>(false)) {}

void ProgressBar::operator()(const batch::Progress& p) {
  const double wait = terminal_ ? (p.done < p.total ? 0.1 : 0.0) : shown_ < 0.0 ? 10.0 : 60.0;
  if (p.seconds - std::max(shown_, 0.0) < wait) return;
  shown_ = p.seconds;
  const double share = static_cast<double>(p.done) / static_cast<double>(p.total),
               rate = static_cast<double>(p.done) / std::max(p.seconds, 1e-9);
  const std::string text = fmt::format("{}/{}  {:.3g} {}/s  {} left", p.done, p.total, rate, unit_,
                                       clock_text(static_cast<double>(p.total - p.done) / rate));
  const auto filled = static_cast<std::size_t>(30.0 * share);
  line_->tell(terminal_ ? fmt::format("[{}{}] {}", std::string(filled, '#'), std::string(30 - filled, '.'), text)
                        : fmt::format("{}  {}", clock_text(p.seconds), text));
}

}  // namespace accdec::cli
