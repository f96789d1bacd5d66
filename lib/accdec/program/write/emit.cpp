#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include <accdec/program/plan/corner_limits.hpp>
#include <accdec/program/read/number.hpp>
#include <accdec/program/write/emitted_filters.hpp>
#include <accdec/program/write/program_report.hpp>

namespace accdec {
namespace {

/// Writes words line by line, handing them on in portions.
class Emission {
 public:
  Emission(const ProgramResult& result, std::ostream& out)
      : result_(result), path_(result.path), n_(path_.dimensions()), out_(out), written_(n_, "0") {}

  void write() {
    header();
    const Machine machine = program_machine(result_.task_machine, path_);
    const LegFilters common(result_.filter);
    const CornerLimits limits(common, machine, result_.sample_period);
    for (std::size_t b = 0; b < path_.blocks(); ++b) {
      passed(b);
      if (!result_.legs.single() && (b == 0 || result_.legs.index(b) != result_.legs.index(b - 1))) {
        line("(filter of {} taps)", result_.legs.of(b).order() + 1);
      }
      path_mode(b);
      block(b, limits);
      rest(b);
      if (text_.size() > 60000) flush();
    }
    passed(path_.blocks());
    leave_notes();
    line("{}", path_.end.empty() ? "M2" : path_.end);
    if (path_.percent) line("%");
    flush();
  }

 private:
  template <class... Arguments>
  void line(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    fmt::format_to(std::back_inserter(text_), format, std::forward<Arguments>(arguments)...);
    text_.push_back('\n');
  }
  void flush() {
    out_.write(text_.data(), static_cast<std::streamsize>(text_.size()));
    text_.clear();
  }

  void header() {
    if (path_.percent) line("%");
    if (!path_.label.empty()) line("{}", path_.label);
    const double period = result_.sample_period * 1e3;
    if (result_.legs.single()) {
      line("(planned for a filter of {} taps at T = {} ms)", result_.filter.order() + 1, plain_number(period, 6));
    } else {
      line("(planned for a filter a leg at T = {} ms)", plain_number(period, 6));
    }
    line(
        "(G4 without an exact stop before it holds the command back, ahead of the filter: the axes need not come to "
        "rest)");
    line("(read back by: accdec program FILE --task TASK.toml --plan {} --dwells-before-filter{})",
         result_.legs.single() ? "fixed" : "per-leg", result_.feeds_chosen ? "" : " --feeds keep");
    text_.append(filter_remarks(result_.filter));
    line("G21 G17 G90 G94");
    position();
  }

  /// To where the program begins: at rest there, rapidly where every axis has a limit of velocity, else at the first
  /// feed.
  void position() {
    std::string to;
    bool limited = true;
    for (std::size_t a = 0; a < program_axis_count; ++a) {
      if (path_.begin[a] == 0.0) continue;
      const std::string value = plain_number(path_.begin[a] * 1e3, decimals);
      to.append(1, ' ').append(1, program_axes[a]).append(value);
      const Axis* axis = find_axis(result_.task_machine, a);
      limited = limited && axis != nullptr && axis->velocity_max < unlimited;
      for (std::size_t i = 0; i < n_; ++i) {
        if (path_.axes[i] == a) written_[i] = value;
      }
    }
    if (to.empty()) return;
    line("(to where the program begins)");
    mode_ = "G61.1";
    line("{}", mode_);
    if (limited) {
      line("G0{}", to);
    } else {
      feed_ = feed(0);
      line("G1{} F{}", to, feed_);
    }
  }

  /// Of coordinates in mm: where blocks were split or are chords of an arc, each part takes the time that it was given,
  /// and what is read back is written alike. Zeros at the end are left out.
  static constexpr int decimals = 9;

  /// Axes that do not move are left out: they may stand elsewhere than the program knows, with another offset or not
  /// yet positioned.
  std::string words(const double* point) {
    std::string text;
    for (std::size_t a = 0; a < n_; ++a) {
      std::string value = plain_number(point[a] * 1e3, decimals);
      if (value == written_[a]) continue;
      text.append(1, ' ').append(1, program_axes[path_.axes[a]]).append(value);
      written_[a] = std::move(value);
    }
    return text;
  }

  void passed(std::size_t b) {
    for (; next_passed_ < path_.passed.size() && path_.passed[next_passed_].block <= b; ++next_passed_) {
      const std::string& words = path_.passed[next_passed_].words;
      if (path_.passed[next_passed_].with_block) {
        note(words);
        continue;
      }
      // A program written here and read again does not collect its own remarks.
      bool own = false;
      for (const char* remark : {"(planned for a filter", "(G4 without an exact stop",
                                 "(read back by: ", "(filter taps: ", "(to where the program begins)", "(filter of "}) {
        own = own || words.starts_with(remark);
      }
      if (!own) line("{}", words);
    }
  }

  /// Line numbers and comments go with the first command that their block became.
  void note(const std::string& words) {
    const bool number = words.starts_with('N');
    if (number && (!number_.empty() || !comments_.empty())) leave_notes();
    (number ? number_ : comments_).append(number ? words + " " : " " + words);
  }
  /// Those of blocks too short to be written.
  void leave_notes() {
    const std::string all = number_ + (comments_.empty() ? "" : comments_.substr(1));
    if (!all.empty()) line("{}", all.substr(0, all.find_last_not_of(' ') + 1));
    number_.clear(), comments_.clear();
  }
  template <class... Arguments>
  void command(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    line("{}{}{}", number_, fmt::format(format, std::forward<Arguments>(arguments)...), comments_);
    number_.clear(), comments_.clear();
  }

  /// Of the next joint within whose tolerance a corner is rounded: where a block was split near one, the motion passes
  /// its parts' joint no nearer. 0.0001 where there is none. mm
  double next_tolerance(std::size_t b) const {
    for (; b < path_.blocks() && path_.joint[b] != Joint::stop; ++b) {
      if (path_.tolerance[b] > 0.0 && path_.tolerance[b] < unlimited) return path_.tolerance[b] * 1e3;
    }
    return 0.0001;
  }

  /// How far a widened arc has moved a point, m, up to whole micrometres: the motion passes within the tolerance of
  /// where the program has it, and may be so much farther from where it is commanded.
  double moved(std::size_t i) const {
    double sum = 0.0;
    for (std::size_t a = 0; a < n_; ++a) sum += std::pow(path_.point(i)[a] - path_.asked(i)[a], 2);
    return std::ceil(std::sqrt(sum) * 1e6) * 1e-6;
  }

  /// How the joint at the block's end is to be passed.
  void path_mode(std::size_t b) {
    if (b + 1 == path_.blocks()) return;
    std::string mode = "G64";
    if (path_.joint[b] == Joint::stop)
      mode = "G61.1";
    else if (path_.tolerance[b] == 0.0)
      mode = "G61";
    else if (path_.tolerance[b] < unlimited)
      mode = "G64 P" + plain_number((path_.tolerance[b] + moved(b + 1)) * 1e3, 9);
    // Straight on with any tolerance or none; as written, coordinates may turn it by their rounding.
    if (path_.joint[b] == Joint::straight && (mode == "G64" || mode == "G61")) {
      if (mode_.starts_with("G64 P")) return;
      mode = "G64 P" + plain_number(next_tolerance(b), 9);
    }
    if (mode == mode_) return;
    mode_ = mode;
    line("{}", mode_);
  }

  /// A rapid move stays one unless it had to be slowed below what the axes and the filter allow it.
  bool rapid(std::size_t b, const CornerLimits& limits) const {
    if (path_.rapid[b] == 0) return false;
    const Machine& machine = result_.task_machine;
    const double* p = path_.point(b);
    double duration = 0.0;
    for (std::size_t a = 0; a < n_; ++a) {
      const Axis* axis = find_axis(machine, path_.axes[a]);
      if (axis != nullptr) duration = std::max(duration, std::abs(p[n_ + a] - p[a]) / axis->velocity_max);
    }
    if (!(duration > 0.0)) return false;
    std::vector<double> velocity(n_);
    for (std::size_t a = 0; a < n_; ++a) velocity[a] = (p[n_ + a] - p[a]) / duration;
    if (result_.feeds_chosen) return path_.duration[b] <= duration * (1.0 + 1e-9);
    return path_.duration[b] <= duration / limits.start_factor(0, velocity.data()) * (1.0 + 1e-6);
  }

  void block(std::size_t b, const CornerLimits& limits) {
    const std::string to = words(path_.point(b + 1));
    if (to.empty()) return;  // shorter than what is written
    if (rapid(b, limits)) {
      command("G0{}", to);
      return;
    }
    const std::string feed = this->feed(b);
    if (feed == feed_) {
      command("G1{}", to);
    } else {
      command("G1{} F{}", to, feed);
      feed_ = feed;
    }
  }

  std::string feed(std::size_t b) const {
    ProgramPoint from{}, end{};
    for (std::size_t a = 0; a < n_; ++a) {
      from[path_.axes[a]] = path_.point(b)[a];
      end[path_.axes[a]] = path_.point(b + 1)[a];
    }
    // feed_duration at unit feed is the length that feeds count.
    return plain_number(feed_duration(from, end, 1.0) / path_.duration[b] * 60e3, 6);
  }

  /// Delays of stops are the exact stop's own; of all other joints, a dwell. Dwells of the program come with what it
  /// passes on.
  void rest(std::size_t b) {
    const bool last = b + 1 == path_.blocks();
    if (!last && path_.joint[b] != Joint::stop && result_.plan.delays[b] > 0) {
      line("G4 P{}", plain_number(static_cast<double>(result_.plan.delays[b]) * result_.sample_period, 9));
    }
  }

  const ProgramResult& result_;
  const Toolpath& path_;
  std::size_t n_;
  std::ostream& out_;
  fmt::memory_buffer text_;
  std::string mode_, feed_;
  std::string number_, comments_;     // of the block to come: "N10 ", " (one) (two)"
  std::vector<std::string> written_;  // of every axis; a program begins at the origin unless it is told otherwise
  std::size_t next_passed_ = 0;
};

}  // namespace

void emit_program(const ProgramResult& result, std::ostream& out) {
  Emission(result, out).write();
}

}  // namespace accdec
