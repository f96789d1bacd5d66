#include <cmath>
#include <string>

#include <fmt/format.h>

#include <accdec/gcode/modal_groups.hpp>
#include <accdec/gcode/move_sink.hpp>
#include <accdec/gcode/move_state.hpp>
#include <accdec/gcode/number.hpp>
#include <accdec/gcode/read_formats.hpp>
#include <accdec/gcode/spline_words.hpp>
#include <accdec/gcode/words.hpp>
#include <accdec/simulate.hpp>

namespace accdec {
namespace {

class Interpreter {
 public:
  Interpreter(LineSource& source, const ReadOptions& options, MoveSink& sink)
      : source_(source), state_(source, sink, options.arc_tolerance), splines_(source, state_), tools_(options.tools) {}

  void run() {
    std::string_view line;
    bool opened = false;
    while (source_.next(line)) {
      const LineKind kind = scan_words(source_, line, words_);
      switch (kind) {
        case LineKind::empty:
          // The program's number is at its head; a later one stays at its place.
          if (label_.empty() && !frame_.opened_by_words)
            label_ = words_.label();
          else if (!words_.label().empty())
            state_.pass(words_.label());
          pass_line("");
          break;
        case LineKind::percent:
          if (opened) return finish();
          opened = frame_.percent = true;
          break;
        case LineKind::words:
          opened = frame_.opened_by_words = true;
          if (!execute()) return finish();
      }
    }
    finish();
  }

 private:
  void finish() {
    splines_.leave(1);
    state_.frame(frame_.percent, label_, end_);
  }
  /// A line without motion: its number, words and comments.
  void pass_line(const std::string& words) {
    std::string text = words_.has('N') ? "N" + plain_number(words_['N'], 6) : "";
    const auto put = [&](std::string_view part) { text.append(text.empty() || part.empty() ? "" : " ").append(part); };
    put(words);
    for (const std::string_view comment : words_.comments()) put(comment);
    if (!text.empty()) state_.pass(text);
  }
  /// The words of a line with motion, and then those that stay on it.
  void pass_with_move(const std::string& words) {
    if (!words.empty()) state_.pass(words);
    if (words_.has('N')) state_.pass("N" + plain_number(words_['N'], 6), true);
    for (const std::string_view comment : words_.comments()) state_.pass(comment, true);
  }
  bool execute();
  bool modal_codes();
  void check_numbers() const;
  void path_control(int tenths);
  std::string other_words() const;
  std::size_t column_of_move() const;
  void move();
  void arc_move(const ProgramPoint& to, std::size_t column);
  ProgramPoint target() const;
  void refuse_unused() const;

  bool take(char letter) {
    if (!words_.has(letter)) return false;
    used_ |= letter_bit(letter);
    return true;
  }

  LineSource& source_;
  MoveState state_;
  SplineWords splines_;
  Words words_;
  bool tools_ = false;  // their lengths are known
  std::uint32_t used_ = 0;
  int motion_ = -1;  // tenths; -1: none yet, 800: cancelled
  struct {
    bool absolute = true, absolute_center = false;
  } distance_;
  struct {
    bool percent = false, opened_by_words = false;
  } frame_;  // what stands round the program
  std::string label_, end_;
};

bool Interpreter::execute() {
  used_ = Words::passed_over;
  for (const Words::Item& g : words_.g_codes()) {
    if (g.tenths != 940) continue;
    state_.feed = 0.0;  // sets the mode and forgets the feed; F of the same block counts after it
    state_.fed = false;
  }
  if (take('F')) {
    state_.feed = words_['F'];
    state_.fed = true;
    if (!(state_.feed >= 0.0)) source_.fail(words_.column('F'), "the feed cannot be negative");
  }
  if ((words_.present() & Words::passed_over) != 0U) check_numbers();
  bool stop = false, end = false;
  unsigned seen = 0;
  for (const Words::Item& m : words_.m_codes()) {
    const MGroup group = m_group(m.tenths);
    if (group == m_unknown) needs_interpreter(source_, m.column, code_name('M', m.tenths));
    if ((seen & (1U << group)) != 0U) {
      source_.fail(m.column, code_name('M', m.tenths) + " contradicts another M word of its group in this block");
    }
    seen |= 1U << group;
    if (group == m_stop) (m.tenths <= 10 ? stop : end) = true;
    if (group == m_stop && end) end_ = code_name('M', m.tenths);
  }
  const bool dwell = words_.g_codes().empty() ? false : modal_codes();
  if (dwell) {
    if (!take('P')) source_.fail(words_.g_codes().front().column, "G4 needs its time in P, in seconds");
    if (words_['P'] < 0.0) source_.fail(words_.column('P'), "a dwell cannot be negative");
    state_.stop(words_['P']);
  }
  bool spline = false;
  for (const Words::Item& g : words_.g_codes()) spline = spline || is_spline(g.tenths);
  // An arc without end words ends where it starts, in its plane; G5.2 and G5.3 need none.
  const bool moves = spline || words_.any_axis() || (words_.present() & Words::arc_centers) != 0U;
  moves ? pass_with_move(other_words()) : pass_line(other_words());
  if (moves) move();
  refuse_unused();
  if (stop) {
    state_.stop(0.0);
    for (const Words::Item& m : words_.m_codes()) {
      if (m.tenths <= 10) state_.pass(code_name('M', m.tenths));
    }
  }
  return !end;
}

/// Words that do not concern motion and come before it.
std::string Interpreter::other_words() const {
  constexpr std::uint32_t numbers = letter_bit('S') | letter_bit('T') | letter_bit('H') | letter_bit('D');
  std::string text;
  if (words_.m_codes().empty() && words_.g_codes().empty() && (words_.present() & numbers) == 0U) return text;
  const auto put = [&](const std::string& word) { text.append(text.empty() ? "" : " ").append(word); };
  for (const Words::Item& g : words_.g_codes()) {
    if (const GGroup group = g_group(g.tenths); group >= g_cutter && group != g_feed_mode)
      put(code_name('G', g.tenths));
  }
  for (const char letter : {'H', 'D', 'T', 'S'}) {
    if (words_.has(letter)) put(letter + plain_number(words_[letter], 6));
  }
  for (const Words::Item& m : words_.m_codes()) {
    if (m_group(m.tenths) != m_stop) put(code_name('M', m.tenths));
  }
  return text;
}

/// Checks words that are ignored but have a form.
void Interpreter::check_numbers() const {
  for (const char letter : {'N', 'T', 'S', 'H', 'D'}) {
    if (!words_.has(letter)) continue;
    const double value = words_[letter];
    const bool whole = letter == 'T' || letter == 'H';
    if (value < 0.0 || (whole && value != std::floor(value))) {
      source_.fail(words_.column(letter),
                   fmt::format("{} must be {} that is not negative", letter, whole ? "a whole number" : "a number"));
    }
  }
}

/// Sets modes in the order of execution of the language; motion comes later. Returns whether there is a dwell.
bool Interpreter::modal_codes() {
  unsigned seen = 0;
  bool dwell = false;
  const Words::Item *path = nullptr, *arc = nullptr;
  for (const Words::Item& g : words_.g_codes()) {
    const GGroup group = g_group(g.tenths);
    if (spindle_synchronised(g.tenths)) {
      source_.fail(g.column,
                   code_name('G', g.tenths) + " moves with the spindle: such moves cannot be planned by time");
    }
    if (group == g_unknown) needs_interpreter(source_, g.column, code_name('G', g.tenths));
    if ((seen & (1U << group)) != 0U) {
      source_.fail(g.column, code_name('G', g.tenths) + " contradicts another G word of its group in this block");
    }
    seen |= 1U << group;
    switch (group) {
      case g_motion:
        motion_ = g.tenths;
        if (motion_ >= 20) arc = &g;  // or a spline
        break;
      case g_cancel_cycle:
        if ((seen & (1U << g_motion)) == 0U) motion_ = 800;  // beside G0 to G3 it is they that count
        break;
      case g_plane: state_.plane = g.tenths == 170 ? Plane::xy : g.tenths == 180 ? Plane::zx : Plane::yz; break;
      case g_distance: distance_.absolute = g.tenths == 900; break;
      case g_arc_distance: distance_.absolute_center = g.tenths == 901; break;
      case g_units: {
        const double unit = g.tenths == 200 ? 0.0254 : 1e-3;
        // F is executed before the units change. So its number is in the old unit, whether it is from this block or an
        // earlier one.
        state_.feed *= state_.unit / unit;
        state_.unit = unit;
        break;
      }
      case g_path: path = &g; break;
      case g_dwell: dwell = true; break;
      case g_coordinates: state_.select(code_name('G', g.tenths)); break;
      case g_tool_length:
        if (g.tenths != 430 || (words_.has('H') && words_['H'] == 0.0)) break;
        if (tools_) needs_interpreter(source_, g.column, "the length of G43");
        state_.select("G43");
        break;
      default: break;
    }
  }
  if (dwell && arc != nullptr) {
    source_.fail(arc->column,
                 "G4 cannot stand in one block with G2, G3 or G5, which use P, too: write them in separate blocks");
  }
  if (dwell && path != nullptr && path->tenths == 640 && words_.has('P')) {
    source_.fail(words_.column('P'), "P could belong to G4 or to G64: write them in separate blocks");
  }
  if (path != nullptr) path_control(path->tenths);
  return dwell;
}

void Interpreter::path_control(int tenths) {
  state_.control = tenths == 611   ? PathControl::exact_stop
                   : tenths == 610 ? PathControl::exact_path
                                   : PathControl::blend;
  if (tenths != 640) return;
  state_.tolerance = state_.merge = -1.0;
  if (take('P')) {
    if (words_['P'] < 0.0) source_.fail(words_.column('P'), "the tolerance of G64 cannot be negative");
    if (words_['P'] > 0.0) state_.tolerance = words_['P'] * state_.unit;  // 0: none given, as in rs274
  }
  // Plans here merge no moves; estimates of LinuxCNC's time do.
  if (take('Q')) state_.merge = words_['Q'] * state_.unit;
}

ProgramPoint Interpreter::target() const {
  ProgramPoint to = state_.position;
  for (std::size_t a = 0; a < program_axis_count; ++a) {
    const char letter = program_axes[a];
    if (!words_.has(letter)) continue;
    const double value = words_[letter] * (a >= 3 && a < 6 ? 1e-3 : state_.unit);
    to[a] = distance_.absolute ? value : to[a] + value;
  }
  return to;
}

/// Column of the first axis word, else of a centre, else of a G word.
std::size_t Interpreter::column_of_move() const {
  if (words_.any_axis()) return words_.first_column(Words::axes);
  if ((words_.present() & Words::arc_centers) != 0U) return words_.first_column(Words::arc_centers);
  return words_.g_codes().front().column;
}

void Interpreter::move() {
  const bool curve = motion_ == 20 || motion_ == 30 || is_spline(motion_);
  if (!words_.any_axis() && !curve) return;  // I J K R will be refused
  used_ |= Words::axes;
  const std::size_t column = column_of_move();
  const ProgramPoint to = target();
  if (is_spline(motion_)) {
    used_ |= splines_.block(words_, motion_, state_.plane, distance_.absolute, to, column);
    if (motion_ == 53) motion_ = -1;
    return;
  }
  splines_.leave(column);
  switch (motion_) {
    case 0: state_.straight(to, true, column); return;
    case 10: state_.straight(to, false, column); return;
    case 20:
    case 30: arc_move(to, column); return;
    default: source_.fail(column, "axis word without a motion: G0, G1, G2, G3 or G5 must come first");
  }
}

void Interpreter::arc_move(const ProgramPoint& to, std::size_t column) {
  Arc arc;
  arc.to = to;
  int turns = 1;
  if (take('P')) {
    const double p = words_['P'];
    if (!(p >= 1.0 && p <= 1e6 && p == std::floor(p))) {
      source_.fail(words_.column('P'), "P of an arc is its number of turns, a whole number from 1");
    }
    turns = static_cast<int>(p);
  }
  const bool clockwise = motion_ == 20;
  if (take('R')) {
    const double radius = words_['R'] * state_.unit;
    state_.arc(arc, clockwise, turns, &radius, column);
    return;
  }
  const std::size_t first = MoveState::first_axis(state_.plane), second = MoveState::second_axis(state_.plane);
  const char i = static_cast<char>('I' + first), j = static_cast<char>('I' + second);
  const bool has_i = take(i), has_j = take(j);
  if (!has_i && !has_j) source_.fail(column, fmt::format("an arc in this plane needs R, or {} and {}", i, j));
  if (distance_.absolute_center && !(has_i && has_j)) {
    source_.fail(column, fmt::format("with G90.1 an arc needs both {} and {}", i, j));
  }
  arc.center_first =
      (has_i ? words_[i] * state_.unit : 0.0) + (distance_.absolute_center ? 0.0 : state_.position[first]);
  arc.center_second =
      (has_j ? words_[j] * state_.unit : 0.0) + (distance_.absolute_center ? 0.0 : state_.position[second]);
  state_.arc(arc, clockwise, turns, nullptr, column);
}

void Interpreter::refuse_unused() const {
  const std::uint32_t unused = words_.present() & ~used_;
  if (unused == 0U) return;
  for (char letter = 'A'; letter <= 'Z'; ++letter) {
    if ((unused & letter_bit(letter)) != 0U) {
      source_.fail(words_.column(letter), fmt::format("word {} has no meaning in this block", letter));
    }
  }
}

}  // namespace

void read_rs274(LineSource& source, const ReadOptions& options, MoveSink& sink) {
  Interpreter(source, options, sink).run();
}

}  // namespace accdec
