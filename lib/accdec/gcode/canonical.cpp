#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <utility>

#include <accdec/gcode/canonical_call.hpp>
#include <accdec/gcode/canonical_position.hpp>
#include <accdec/gcode/modal_groups.hpp>
#include <accdec/gcode/move_sink.hpp>
#include <accdec/gcode/move_state.hpp>
#include <accdec/gcode/number.hpp>
#include <accdec/gcode/printed_splines.hpp>
#include <accdec/gcode/read_formats.hpp>
#include <accdec/simulate.hpp>

namespace accdec {

namespace {

constexpr const char* allowed_calls =
    "; allowed: STRAIGHT_TRAVERSE STRAIGHT_FEED ARC_FEED SET_FEED_RATE USE_LENGTH_UNITS SELECT_PLANE "
    "SET_MOTION_CONTROL_MODE DWELL "
    "PROGRAM_STOP PROGRAM_END, and what rs274 -g prints for spindle, tools, coolant, comments and messages";

class CanonicalReader {
 public:
  CanonicalReader(LineSource& source, const ReadOptions& options, MoveSink& sink)
      : source_(source),
        state_(source, sink, options.arc_tolerance),
        numbered_(options.numbered),
        position_(state_),
        splines_(source, state_, position_) {}

  void run() {
    while (source_.next(line_)) {
      if (line_.find_first_not_of(" \t") == std::string_view::npos) continue;
      call_ = find_call(line_);
      if (call_.name.empty()) source_.fail(1, std::string("no canonical call in this line") + allowed_calls);
      if (numbered_ && call_.program_line > 0) {
        source_.stands_for(call_.program_line);
        started_ = true;
      }
      // Its message comes at once.
      if (call_.name != "MESSAGE") splines_.leave();
      if (!execute()) return;
    }
    splines_.leave();
  }

 private:
  bool execute();
  void other_call();
  void pass_call();
  void numbers(std::size_t least, std::size_t most);
  void zeros(std::size_t from, const char* what);
  /// The arguments as text; nothing may come after `close`.
  std::string_view text(std::string_view close = ")") const {
    const std::size_t end = line_.find(close, call_.arguments);
    if (end == std::string_view::npos) source_.fail(line_.size() + 1, "call without its ')'");
    nothing_from(end + close.size());
    return line_.substr(call_.arguments, end - call_.arguments);
  }
  void nothing_from(std::size_t index) const {
    const std::size_t more = line_.find_first_not_of(" \t", index);
    if (more != std::string_view::npos) source_.fail(more + 1, "text after the call: one call a line");
  }
  [[noreturn]] void bad_word(std::string_view words) const {
    source_.fail(call_.arguments + 1,
                 "unknown argument of " + std::string(call_.name) + ", allowed: " + std::string(words));
  }
  ProgramPoint offsets(std::size_t from) const;
  void offset_call();
  void straight(bool rapid);
  void arc();
  void control();
  void feed();

  LineSource& source_;
  MoveState state_;
  std::string_view line_;
  CanonicalCall call_;
  bool numbered_, started_ = false;  // started: a line of the program has been seen
  CanonicalPosition position_;
  PrintedSplines splines_;
  struct {
    double printed_tolerance = 0.0;  // of the last G64, as printed, in the unit that was in force then
    std::int64_t exact_line = 0;     // of the last exact mode
    bool restored = false;           // the last G64 is a cycle's, which restores that before it
  } blend_;
  struct {
    std::array<double, 10> value{};
    std::size_t count = 0;
  } numbers_;  // of the call
};

void CanonicalReader::numbers(std::size_t least, std::size_t most) {
  const char* const begin = line_.data();
  const char* const end = begin + line_.size();
  const char* p = begin + call_.arguments;
  const auto column = [&] { return static_cast<std::size_t>(p - begin) + 1; };
  const auto blanks = [&] {
    while (p != end && (*p == ' ' || *p == '\t')) ++p;
  };
  const bool with_blanks = call_.name == "USE_TOOL_LENGTH_OFFSET";  // a comma behind every third
  numbers_.count = 0;
  for (;;) {
    blanks();
    if (numbers_.count == most) source_.fail(column(), "more than " + std::to_string(most) + " arguments");
    if (!read_number(p, end, numbers_.value[numbers_.count])) source_.fail(column(), "not a number from -1e12 to 1e12");
    ++numbers_.count;
    blanks();
    if (with_blanks && p != end && p[-1] == ' ' && *p != ',' && *p != ')') continue;
    if (p == end || (*p != ',' && *p != ')')) source_.fail(column(), "',' or ')' expected");
    if (*p++ == ')') break;
  }
  nothing_from(column() - 1);
  if (numbers_.count < least) source_.fail(column() - 1, "fewer than " + std::to_string(least) + " arguments");
}

bool CanonicalReader::execute() {
  const std::string_view name = call_.name;
  if (name == "STRAIGHT_FEED" || name == "STRAIGHT_TRAVERSE") {
    straight(name == "STRAIGHT_TRAVERSE");
  } else if (name == "ARC_FEED") {
    arc();
  } else if (name == "SET_FEED_RATE") {
    feed();
  } else if (name == "USE_LENGTH_UNITS") {
    const std::string_view unit = text();
    const double old = state_.unit;
    if (unit == "CANON_UNITS_MM")
      state_.unit = 1e-3;
    else if (unit == "CANON_UNITS_INCHES")
      state_.unit = 0.0254;
    else
      bad_word("CANON_UNITS_MM, CANON_UNITS_INCHES");
    state_.feed *= old / state_.unit;
  } else if (name == "SELECT_PLANE") {
    const std::string_view plane = text();
    if (plane == "CANON_PLANE_XY")
      state_.plane = Plane::xy;
    else if (plane == "CANON_PLANE_XZ")
      state_.plane = Plane::zx;
    else if (plane == "CANON_PLANE_YZ")
      state_.plane = Plane::yz;
    else if (plane == "CANON_PLANE_UNKNOWN")  // as rs274 prints them
      source_.fail(call_.column + 1, "G17.1, G18.1 and G19.1, planes of U V W, are not supported");
    else
      bad_word("CANON_PLANE_XY, CANON_PLANE_XZ, CANON_PLANE_YZ");
  } else if (name == "SET_MOTION_CONTROL_MODE") {
    control();
  } else if (name == "SET_NAIVECAM_TOLERANCE") {
    numbers(1, 1);
    // Q of the G64 before it, or its P, with four decimals. Behind a cycle the Q in force stays, as P does.
    if (!blend_.restored)
      state_.merge =
          std::abs(numbers_.value[0] - blend_.printed_tolerance) < 6e-5 ? -1.0 : numbers_.value[0] * state_.unit;
  } else if (name == "DWELL") {
    numbers(1, 1);
    if (numbers_.value[0] < 0.0) source_.fail(call_.arguments + 1, "a dwell cannot be negative");
    state_.stop(numbers_.value[0]);
  } else if (name == "PROGRAM_STOP" || name == "OPTIONAL_PROGRAM_STOP") {
    text();
    state_.stop(0.0);
    state_.pass(name == "PROGRAM_STOP" ? "M0" : "M1");
  } else if (name == "PROGRAM_END") {
    text();
    return false;
  } else {
    other_call();
  }
  return true;
}

void CanonicalReader::other_call() {
  const std::string_view name = call_.name;
  switch (call_kind(name)) {
    case CallKind::text:
      // A quoted text may hold anything but the two characters that end it.
      splines_.message(text(line_.substr(call_.arguments).starts_with('"') ? "\")" : ")"));
      break;
    case CallKind::passed_over: pass_call(); break;
    case CallKind::followed:
      if (name == "SET_FEED_MODE") {
        numbers(1, 2);
        zeros(numbers_.count - 1, "only feed per minute (mode 0) is supported");
      } else {
        offset_call();
      }
      break;
    case CallKind::unsupported:
      if (name.starts_with("NURBS")) return splines_.feed(call_.column + 1);
      if (name.starts_with("START_SPEED_FEED_SYNC") || name == "RIGID_TAP") {
        source_.fail(call_.column + 1, std::string(name == "RIGID_TAP" ? "G33.1" : "G33, G76 or G95") +
                                           " moves with the spindle: such moves cannot be planned by time");
      }
      if (name == "STRAIGHT_PROBE") {
        source_.fail(call_.column + 1,
                     "G38.2 to G38.5 end where the probe touches: such moves cannot be planned by time");
      }
      source_.fail(call_.column + 1, std::string(name) + " is not supported" + allowed_calls);
    case CallKind::unknown: source_.fail(call_.column + 1, std::string(name) + " is an unknown call" + allowed_calls);
  }
}

/// Calls that a written program keeps, as the words they came from. Arguments of other calls are ignored.
void CanonicalReader::pass_call() {
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 7> words{
      {{"START_SPINDLE_CLOCKWISE", "M3"},
       {"START_SPINDLE_COUNTERCLOCKWISE", "M4"},
       {"STOP_SPINDLE_TURNING", "M5"},
       {"MIST_ON", "M7"},
       {"FLOOD_ON", "M8"},
       {"MIST_OFF", "M9"},
       {"FLOOD_OFF", "M9"}}};
  const std::string_view name = call_.name, arguments = text();
  for (const auto& [call, word] : words) {
    if (name == call) state_.pass(word);
  }
  const bool number = name == "SET_SPINDLE_SPEED" || name == "SELECT_TOOL" || name == "CHANGE_TOOL";
  const bool empty = arguments.find_first_not_of(" \t") == std::string_view::npos;
  if (name == "CHANGE_TOOL" && empty) state_.pass("M6");
  if (!number || empty) return;
  numbers(1, 10);
  // If there are several, the spindle's or pocket's number comes first.
  const std::string value = plain_number(numbers_.value[numbers_.count - 1], 6);
  state_.pass(name == "SET_SPINDLE_SPEED" ? "S" + value : name == "SELECT_TOOL" ? "T" + value : "T" + value + " M6");
}

void CanonicalReader::zeros(std::size_t from, const char* what) {
  for (std::size_t i = from; i < numbers_.count; ++i) {
    if (numbers_.value[i] != 0.0) source_.fail(call_.column + 1, what);
  }
}

void CanonicalReader::feed() {
  numbers(1, 1);
  if (numbers_.value[0] < 0.0) source_.fail(call_.arguments + 1, "a feed cannot be negative");
  state_.feed = numbers_.value[0];  // 0 is what an interpreter prints before the first F word
}

ProgramPoint CanonicalReader::offsets(std::size_t from) const {
  ProgramPoint values{};
  for (std::size_t i = from; i < numbers_.count; ++i) values[i - from] = position_.scaled(numbers_.value[i], i - from);
  return values;
}

void CanonicalReader::offset_call() {
  const std::string_view name = call_.name;
  ProgramFrame frame = position_.frame();
  if (name == "SET_XY_ROTATION") {
    numbers(1, 1);
    frame.rotation = numbers_.value[0] * std::numbers::pi / 180.0;
  } else if (name == "SET_G5X_OFFSET") {
    numbers(2, 10);
    const double system = numbers_.value[0];
    // The system that rs274 prints first is no word of the program.
    if ((!numbered_ || started_) && system >= 1.0 && system <= 9.0 && system == std::floor(system)) {
      const int tenths = system <= 6.0 ? 530 + 10 * static_cast<int>(system) : 584 + static_cast<int>(system);
      state_.select(code_name('G', tenths));
    }
    frame.system = offsets(1);
  } else {
    numbers(1, 9);
    (name == "SET_G92_OFFSET" ? frame.g92 : frame.tool) = offsets(0);
  }
  position_.set_frame(frame);
}

void CanonicalReader::straight(bool rapid) {
  numbers(3, program_axis_count);
  ProgramPoint to = position_.here();
  for (std::size_t a = 0; a < numbers_.count; ++a) to[a] = position_.coordinate(numbers_.value[a], a);
  position_.end_of_coordinates();
  const ProgramPoint machine = position_.machine_of(to);
  position_.go(to);
  state_.straight(machine, rapid, call_.column + 1);
}

void CanonicalReader::arc() {
  numbers(6, 9);
  ProgramPoint to = position_.here(), center = position_.here();
  const std::size_t first = MoveState::first_axis(state_.plane), second = MoveState::second_axis(state_.plane);
  const std::size_t normal = 3 - first - second;
  if (position_.frame().rotation != 0.0 && state_.plane != Plane::xy)
    source_.fail(call_.column + 1, "arcs outside the XY plane are not supported where G10 R rotates it");
  to[first] = position_.coordinate(numbers_.value[0], first);
  to[second] = position_.coordinate(numbers_.value[1], second);
  center[first] = position_.scaled(numbers_.value[2], first);
  center[second] = position_.scaled(numbers_.value[3], second);
  to[normal] = position_.coordinate(numbers_.value[5], normal);
  for (std::size_t a = 6; a < numbers_.count; ++a) to[a - 3] = position_.coordinate(numbers_.value[a], a - 3);
  position_.end_of_coordinates();
  const double turns = numbers_.value[4];
  if (turns == 0.0 || turns != std::floor(turns) || std::abs(turns) > 1e6) {
    source_.fail(call_.arguments + 1, "the fifth argument of an arc is its number of turns, positive counterclockwise");
  }
  Arc arc;
  arc.to = position_.machine_of(to);
  // A helix as narrow as its cutter leaves the interpreter's compensation as a line along its axis.
  const bool narrow = to[first] == position_.here()[first] && to[second] == position_.here()[second] &&
                      std::hypot(center[first] - to[first], center[second] - to[second]) <= 0.5001e-4 * state_.unit;
  if (narrow) {
    position_.go(to);
    state_.straight(arc.to, false, call_.column + 1);
    return;
  }
  center = position_.frame().to_machine(center);
  arc.center_first = center[first];
  arc.center_second = center[second];
  position_.go(to);
  state_.arc(arc, turns < 0.0, static_cast<int>(std::abs(turns)), nullptr, call_.column + 1);
}

void CanonicalReader::control() {
  const std::string_view arguments = text();
  const std::size_t comma = arguments.find(',');
  const std::string_view mode = arguments.substr(0, comma);
  if (mode == "CANON_EXACT_STOP")
    state_.control = PathControl::exact_stop;
  else if (mode == "CANON_EXACT_PATH")
    state_.control = PathControl::exact_path;
  else if (mode == "CANON_CONTINUOUS")
    state_.control = PathControl::blend;
  else
    bad_word("CANON_EXACT_STOP, CANON_EXACT_PATH, CANON_CONTINUOUS");
  if (state_.control != PathControl::blend) {
    blend_.exact_line = call_.program_line;
    return;
  }
  blend_.restored = false;
  const double before = std::exchange(state_.tolerance, -1.0);
  const double printed = std::exchange(blend_.printed_tolerance, 0.0);
  if (comma == std::string_view::npos) return;
  call_.arguments += comma + 1;
  numbers(1, 1);
  blend_.printed_tolerance = numbers_.value[0];
  if (numbers_.value[0] <= 0.0) return;  // 0 stands for G64 without P
  state_.tolerance = numbers_.value[0] * state_.unit;
  // A cycle makes the path exact in its own line. At its end rs274 prints the number of G64 P once more, in the unit
  // that was in force then. Calls without line numbers may come from another G64 P with that number: the smaller holds.
  if (numbers_.value[0] != printed || before <= 0.0) return;
  blend_.restored = call_.program_line > 0 ? call_.program_line == blend_.exact_line : before < state_.tolerance;
  if (blend_.restored) state_.tolerance = before;
}

}  // namespace

void read_canonical(LineSource& source, const ReadOptions& options, MoveSink& sink) {
  CanonicalReader(source, options, sink).run();
}

}  // namespace accdec
