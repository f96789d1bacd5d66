#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <fmt/format.h>

#include <accdec/gcode/emitted_filters.hpp>
#include <accdec/gcode/move_sink.hpp>
#include <accdec/gcode/number.hpp>
#include <accdec/plan/emit/dialect_words.hpp>
#include <accdec/plan/emit/emit.hpp>
#include <accdec/plan/emit/emitted_lines.hpp>
#include <accdec/plan/emit/timed_moves.hpp>
#include <accdec/plan/filters/program_settings.hpp>
#include <accdec/program.hpp>
#include <accdec/task/delay_kinds.hpp>

namespace accdec {
namespace {

/// As a remark can hold them, without parentheses.
std::string words_to_set(const ProgramResult& result) {
  std::string text = program_settings_in_words(result);
  std::replace(text.begin(), text.end(), '(', '[');
  std::replace(text.begin(), text.end(), ')', ']');
  return text;
}

constexpr const char* set_remark = "(set these: ";
constexpr const char* in_position_remark = "(G9:";
constexpr const char* slowed_remark = "(rapid moves stand as G1";

/// @param latency  s, of the control
std::string after_in_position(double latency) {
  return latency > 0.0 ? fmt::format("{} ms after", plain_number(1e3 * latency, 6)) : "as soon as";
}

/// The kind of delay of a joint; any number of samples where the plan names none.
DelayKind kind_of(const ProgramResult& result, std::size_t b) {
  const bool known = result.settings && b < result.settings->chosen.delays.size();
  return known ? result.settings->chosen.delays[b] : DelayKind::dwell;
}

/// Whether a block ends in a full stop, whatever kinds of delays the control has for corners.
bool ends_in_stop(const ProgramResult& result, std::size_t b) {
  return result.plan.path.joint[b] == Joint::stop || kind_of(result, b) == DelayKind::exact_stop;
}

/// Samples of G4 behind a joint that is no stop of the program.
int dwell(const ProgramResult& result, std::size_t b) {
  const Toolpath& path = result.plan.path;
  if (b + 1 == path.blocks() || path.joint[b] == Joint::stop) return 0;
  const DelayKind kind = kind_of(result, b);
  if (kind == DelayKind::in_position) return 0;
  const int stop = kind == DelayKind::exact_stop ? exact_stop_delay(result.plan.filter()) : 0;
  return std::max(0, result.plan.delay(b) - stop);
}

/// Whether any G4 holds the command back without an exact stop.
bool dwells(const ProgramResult& result) {
  for (std::size_t b = 0; b < result.plan.path.blocks(); ++b) {
    if (kind_of(result, b) != DelayKind::exact_stop && dwell(result, b) > 0) return true;
  }
  return false;
}

/// Writes a plan block by block.
class Emission {
 public:
  /// @param timed_axis  see emit_for_linuxcnc; 0: none
  Emission(const ProgramResult& result, char timed_axis, std::ostream& out)
      : result_(result),
        path_(result.plan.path),
        machine_(program_machine(result.task_machine, path_)),
        lines_(out),
        timed_(timed_axis),
        words_(result, timed_axis == 0),
        decimals_(decimals_needed()),
        written_(path_.dimensions(), "0") {}

  void write() {
    if (timed_.used()) timed_.require(result_);
    // Read back, they are feed moves, and the remark stays.
    bool slowed_rapids = std::any_of(path_.kept_words.begin(), path_.kept_words.end(),
                                     [](const auto& passed) { return passed.words.starts_with(slowed_remark); });
    for (std::size_t b = 0; b < path_.blocks(); ++b)
      slowed_rapids = slowed_rapids || (path_.rapid[b] != 0 && !stands_as_rapid(path_, b, machine_));
    header(slowed_rapids);
    for (std::size_t b = 0; b < path_.blocks(); ++b) {
      passed(b);
      path_mode(b);
      block(b);
      rest(b);
      lines_.pass_on();
    }
    passed(path_.blocks());
    lines_.leave_notes();
    line("{}", path_.end.empty() ? "M2" : path_.end);
    if (path_.percent) line("%");
    lines_.flush();
  }

 private:
  template <class... Arguments>
  void line(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    lines_.line(format, std::forward<Arguments>(arguments)...);
  }

  void header(bool slowed_rapids) {
    if (path_.percent) line("%");
    if (!path_.label.empty()) line("{}", path_.label);
    const double period = result_.sample_period * 1e3;
    line("{}", words_.remark(fmt::format("(planned for a filter of {} taps at T = {} ms)",
                                         result_.plan.set().order() + 1, plain_number(period, 6))));
    if (words_.used()) {
      line("{}", words_.remark(fmt::format("{}{})", set_remark, words_to_set(result_))));
      if (slowed_rapids) line("{}", words_.remark(fmt::format("{} where the plan runs them slower)", slowed_remark)));
      for (const std::string& words : words_.begin()) line("{}", words);
      return position();
    }
    if (timed_.used())
      lines_.append(timed_.remark());
    else if (dwells(result_))
      line(
          "(G4 without an exact stop before it holds the command back, ahead of the filter: the axes need not come to "
          "rest)");
    if (result_.settings) line("{}{})", set_remark, words_to_set(result_));
    if (result_.settings && result_.settings->chosen.width)
      line("{} the next block starts {} the axes are within the in-position width of the block's end)",
           in_position_remark, after_in_position(path_.control.latency * result_.sample_period));
    else if (!timed_.used())
      line("(read back by: accdec program FILE --task TASK.toml --plan fixed --dwells-before-filter{}{})",
           result_.feeds_chosen ? "" : " --feeds keep", path_.length_at ? " --tool-length 0" : "");
    if (slowed_rapids) line("{} where the plan runs them slower than G0, which would break a limit)", slowed_remark);
    lines_.append(filter_remarks(result_.plan.set()));
    line("G21 G17 G90 G94");
    lines_.append(timed_.begin());
    position();
  }

  /// Moves to the beginning of the program and rests there: as a rapid move if every axis has a velocity limit, else at
  /// the first feed.
  void position() {
    std::string to;
    bool limited = true;
    for (std::size_t a = 0; a < program_axis_count; ++a) {
      if (path_.begin[a] == 0.0) continue;
      const std::string value = coordinate(path_.begin[a] * 1e3);
      to.append(1, ' ').append(1, program_axes[a]).append(value);
      const Axis* axis = find_axis(result_.task_machine, a);
      limited = limited && axis != nullptr && axis->velocity_max < unlimited;
      for (std::size_t i = 0; i < path_.dimensions(); ++i) {
        if (path_.axes[i] == a) written_[i] = value;
      }
    }
    if (to.empty()) return;
    line("{}", words_.remark("(to where the program begins)"));
    if (words_.used()) {
      to += words_.at_stop();
    } else {
      mode_ = "G61.1";
      line("{}", mode_);
    }
    if (limited) {
      line("G0{}", to);
    } else {
      feed_ = feed(0);
      line("G1{} F{}", to, feed_);
    }
    if (const std::string wait = words_.behind_stop(result_.plan.filter()); !wait.empty()) line("{}", wait);
  }

  /// Decimals of coordinates in mm. Rounding a position by q changes an acceleration by up to 4 q/T^2 and a jerk by
  /// 8 q/T^3. Both limits must still hold when the program is read back. Every block keeps its number of samples to
  /// 1e-7, even if it was split or is a chord of an arc.
  int decimals_needed() const {
    double least = 1e-12;  // m
    for (std::size_t b = 0; b < path_.blocks(); ++b) {
      least = std::min(least, 1e-7 * path_.length(b) / path_.duration[b] * result_.sample_period);
    }
    for (const LimitUse& use : result_.check.limits) {
      const bool jerk = use.kind == LimitKind::jerk;
      if (!jerk && use.kind != LimitKind::acceleration) continue;
      const double left = use.bound * (1e-9 + std::max(0.0, 1.0 - use.utilisation));
      const double period = result_.sample_period;
      least = std::min(least, left * period * period * (jerk ? period : 1.0) / (jerk ? 8.0 : 4.0));
    }
    return std::clamp(static_cast<int>(std::ceil(-std::log10(least * 1e3))), 9, 13);
  }
  /// In mm. Zeros at the end are left out; no more digits than a double has.
  std::string coordinate(double value) const {
    const int before = std::abs(value) < 10.0 ? 1 : static_cast<int>(std::log10(std::abs(value))) + 1;
    return plain_number(value, std::min(decimals_, std::max(9, 15 - before)));
  }

  /// Axes that do not move are left out. They may be at another place than the program knows, with another offset or
  /// not yet positioned.
  std::string words(const double* point) {
    std::string text;
    for (std::size_t a = 0; a < path_.dimensions(); ++a) {
      std::string value = coordinate(point[a] * 1e3);
      if (value == written_[a]) continue;
      text.append(1, ' ').append(1, program_axes[path_.axes[a]]).append(value);
      written_[a] = std::move(value);
    }
    return text;
  }

  void passed(std::size_t b) {
    for (; next_passed_ < path_.kept_words.size() && path_.kept_words[next_passed_].block <= b; ++next_passed_) {
      const std::string& words = path_.kept_words[next_passed_].words;
      if (path_.kept_words[next_passed_].with_block) {
        lines_.note(words_.remark(words));
        continue;
      }
      // A program that was written here and read again does not accumulate remarks.
      bool own = false;
      for (const char* remark : {"(planned for a filter", "(G4 without an exact stop",
                                 "(read back by: ", "(filter taps: ", "(to where the program begins)", "(filter of ",
                                 set_remark, in_position_remark, slowed_remark}) {
        own = own || words.starts_with(remark);
      }
      if (!own) line("{}", words_.passed(words));
    }
  }

  /// Tolerance of the next joint with a rounded corner. If a block was split near it, the motion passes the joint of
  /// its parts no nearer. 0.0001 if there is none. mm
  double next_tolerance(std::size_t b) const {
    for (; b < path_.blocks() && path_.joint[b] != Joint::stop; ++b) {
      if (path_.tolerance[b] > 0.0 && path_.tolerance[b] < unlimited) return path_.tolerance[b] * 1e3;
    }
    return 0.0001;
  }

  /// Distance by which a widened arc has moved a point, m, rounded up to whole micrometres. The motion passes within
  /// the tolerance of the programmed point, so it may be this much farther from the commanded point.
  double moved(std::size_t i) const {
    double sum = 0.0;
    for (std::size_t a = 0; a < path_.dimensions(); ++a)
      sum += std::pow(path_.point(i)[a] - path_.programmed_point(i)[a], 2);
    return std::ceil(std::sqrt(sum) * 1e6) * 1e-6;
  }

  /// How the joint at the block's end is to be passed.
  void path_mode(std::size_t b) {
    if (b + 1 == path_.blocks() || words_.used()) return;
    std::string mode = "G64";
    if (timed_.used()) {
      if (result_.plan.delay(b) > 0) mode = "G61";
    } else if (path_.joint[b] == Joint::stop || kind_of(result_, b) == DelayKind::exact_stop)
      mode = "G61.1";
    else if (path_.tolerance[b] == 0.0)
      mode = "G61";
    else if (path_.tolerance[b] < unlimited)
      mode = "G64 P" + plain_number((path_.tolerance[b] + moved(b + 1)) * 1e3, 9);
    // A straight joint with any tolerance or none; in the written text, coordinates may turn it by their rounding. Then
    // the tolerance in force must hold there, too.
    if (!timed_.used() && path_.joint[b] == Joint::straight && (mode == "G64" || mode == "G61")) {
      const bool rounded = mode_.starts_with("G64 P");
      // Behind a servo the motion still turns where the command has gone on along a straight line.
      const double now = rounded ? std::stod(mode_.substr(5)) : 0.0;
      const double next = std::max(next_tolerance(b), std::ceil(1.05e9 * result_.errors[b]) * 1e-6);
      if (rounded && (next <= now || 1e3 * result_.errors[b] < 0.99 * now)) return;
      mode = "G64 P" + plain_number(next, 9);
    }
    if (mode == mode_) return;
    mode_ = mode;
    line("{}", mode_);
  }

  void block(std::size_t b) {
    std::string to = words(path_.point(b + 1));
    if (to.empty()) return;  // shorter than what is written
    const bool nine = !words_.used() && kind_of(result_, b) == DelayKind::in_position;
    const char* const in_position = nine ? "G9 " : "";
    const bool last = b + 1 == path_.blocks();
    const std::string behind = !words_.used() || last     ? ""
                               : ends_in_stop(result_, b) ? words_.at_stop()
                                                          : words_.at(kind_of(result_, b));
    if (stands_as_rapid(path_, b, machine_)) {
      lines_.command("{}G0{}{}", in_position, to, behind);
      return;
    }
    const std::string feed = this->feed(b);
    if (feed != feed_) to += " F" + feed;
    lines_.command("{}G1{}{}", in_position, to, behind);
    feed_ = feed;
  }

  std::string feed(std::size_t b) const {
    ProgramPoint from{}, end{};
    for (std::size_t a = 0; a < path_.dimensions(); ++a) {
      from[path_.axes[a]] = path_.point(b)[a];
      end[path_.axes[a]] = path_.point(b + 1)[a];
    }
    // feed_duration at unit feed is the length that feeds count.
    // Eleven digits: runs that last whole samples still do when they are read back.
    const double value = feed_duration(from, end, 1.0) / path_.duration[b] * 60e3;
    return plain_number(value, std::clamp(10 - static_cast<int>(std::floor(std::log10(value))), 6, 15));
  }

  /// The delay of a stop belongs to the exact stop. All other joints get a dwell. Dwells of the program come with the
  /// words passed on.
  void rest(std::size_t b) {
    const bool last = b + 1 == path_.blocks();
    if (words_.used()) {
      if (last) return;
      const std::string wait = ends_in_stop(result_, b) ? words_.behind_stop(result_.plan.filter())
                                                        : words_.behind(kind_of(result_, b), result_.plan.delay(b));
      if (!wait.empty()) line("{}", wait);
      return;
    }
    if (timed_.used() && !last) {
      const std::string move = timed_.wait(result_.plan.delay(b), result_.sample_period);
      lines_.append(move);
      if (!move.empty()) feed_.clear();
      return;
    }
    if (!last && path_.joint[b] == Joint::stop && !result_.plan.command()->moved.empty()) return servo_rest(b);
    if (const int delay = dwell(result_, b); delay > 0)
      line("G4 P{}", plain_number(static_cast<double>(delay) * result_.sample_period, 9));
  }

  /// The wait of a stop for the servo, beyond the rest of the command.
  void servo_rest(std::size_t b) {
    const int longer = result_.plan.delay(b) - exact_stop_delay(result_.plan.filter());
    if (longer > 0) line("G4 P{}", plain_number(static_cast<double>(longer) * result_.sample_period, 9));
  }

  const ProgramResult& result_;
  const Toolpath& path_;
  const Machine machine_;  // one axis a dimension
  EmittedLines lines_;
  TimedMoves timed_;
  DialectWords words_;
  const int decimals_;
  std::string mode_, feed_;
  std::vector<std::string> written_;  // of every axis; a program begins at the origin unless it is told otherwise
  std::size_t next_passed_ = 0;
};

}  // namespace

bool stands_as_rapid(const Toolpath& path, std::size_t block, const Machine& machine) {
  if (path.rapid[block] == 0) return false;
  const double *from = path.point(block), *to = path.point(block + 1);
  double fastest = 0.0;
  for (std::size_t a = 0; a < machine.axes.size(); ++a)
    fastest = std::max(fastest, std::abs(to[a] - from[a]) / machine.axes[a].velocity_max);
  return fastest > 0.0 && path.duration[block] <= fastest * (1.0 + 1e-9);
}

void emit_program(const ProgramResult& result, std::ostream& out) {
  if (result.settings && result.settings->control) require_dwells(*result.settings->control);
  Emission(result, 0, out).write();
}

void emit_for_linuxcnc(const ProgramResult& result, char axis, std::ostream& out) {
  Emission(result, axis, out).write();
}

}  // namespace accdec
