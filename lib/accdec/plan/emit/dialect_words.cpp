#include <stdexcept>

#include <fmt/format.h>

#include <accdec/gcode/number.hpp>
#include <accdec/plan/emit/dialect_words.hpp>
#include <accdec/plan/feeds/control_delay.hpp>

namespace accdec {

DialectWords::DialectWords(const ProgramResult& result, bool wanted) : period_(result.sample_period) {
  if (!wanted || !result.settings || result.settings->control == nullptr) return;
  const ControllerSettings& control = *result.settings->control;
  if (!control.from_file) return;
  require_dialect(control);
  if (control.dialect == nullptr) return;
  control_ = &control;
}

void require_dialect(const ControllerSettings& control) {
  const bool told = control.names_family() || limits_taps(control);
  if (!control.from_file || !told || control.dialect != nullptr) return;
  throw std::invalid_argument(
      fmt::format("--emit: no source says which words {} takes for its corners; leave it out, or name a controller's "
                  "`file` of your own that has `delay_words` and [dialect]",
                  control.controller));
}

void require_dwells(const ControllerSettings& control) {
  if (!control.names(DelayKind::timed_axis) || control.names(DelayKind::dwell)) return;
  throw std::invalid_argument(
      "`delays` has \"timed-axis\" and no \"dwell\": --emit needs --dwell-axis, the axis A, B, C, U, V or W that the "
      "program does not use and whose timed moves delay");
}

std::string DialectWords::remark(const std::string& words) const {
  if (!used() || !words.starts_with('(') || !words.ends_with(')')) return words;
  return fmt::format("{}{}{}", control_->dialect->comment, words.substr(1, words.size() - 2),
                     control_->dialect->comment_end);
}

std::string DialectWords::passed(const std::string& words) const {
  constexpr std::string_view wait = "G4 P";
  if (!used() || !words.starts_with(wait)) return remark(words);
  return dwell(words.substr(wait.size()));
}

std::vector<std::string> DialectWords::begin() const {
  std::vector<std::string> lines{"G17 G90 G94"};
  if (!control_->dialect->metric.empty()) lines.front() = control_->dialect->metric + " " + lines.front();
  if (const std::string words = std::string(control_->word_of(DelayKind::continuous)); !words.empty())
    lines.push_back(words);
  return lines;
}

std::string DialectWords::at(DelayKind kind) const {
  if (kind == DelayKind::continuous || kind == DelayKind::corner_feed) return "";
  const std::string_view words = control_->word_of(kind);
  return words.empty() ? "" : fmt::format(" {}", words);
}

std::string DialectWords::at_stop() const {
  if (control_->names(DelayKind::exact_stop)) return at(DelayKind::exact_stop);
  if (control_->names(DelayKind::in_position)) return at(DelayKind::in_position);
  throw std::invalid_argument(fmt::format("--emit: the plan stops, and {} names no exact-stop", control_->controller));
}

std::string DialectWords::behind_stop(const Filter& filter) const {
  if (!used() || control_->names(DelayKind::exact_stop)) return "";
  return dwell(plain_number((filter.order() + 1) * period_, 9));
}

std::string DialectWords::behind(DelayKind kind, int samples) const {
  if (samples == 0 || (kind != DelayKind::dwell && kind != DelayKind::timed_axis)) return "";
  return dwell(plain_number(samples * period_, 9));
}

std::string DialectWords::dwell(const std::string& seconds) const {
  if (control_->dialect->dwell.empty())
    throw std::invalid_argument(
        fmt::format("--emit: the program dwells, and no source says how {} does", control_->controller));
  return control_->dialect->dwell + seconds;
}

}  // namespace accdec
