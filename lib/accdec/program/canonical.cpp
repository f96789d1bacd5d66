#include <accdec/program/reader.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include <accdec/program/canonical_call.hpp>
#include <accdec/program/move_state.hpp>
#include <accdec/program/number.hpp>

namespace accdec {

CanonicalCall find_call(std::string_view line) {
  // "   12 N0010  NAME(arguments)": numbers of the output line and of the input line may come first.
  std::size_t i = line.find_first_not_of(" \t0123456789");
  if (i != std::string_view::npos && line[i] == 'N' && i + 1 < line.size() && line[i + 1] != 'U') {  // not NURBS..
    i = line.find_first_not_of(". \t0123456789", i + 1);
  }
  if (i == std::string_view::npos) return {};
  std::size_t j = i;
  while (j < line.size() && ((line[j] >= 'A' && line[j] <= 'Z') || line[j] == '_' || (line[j] >= '0' && line[j] <= '9'))) ++j;
  if (j - i < 4 || j >= line.size() || line[j] != '(') return {};
  return {line.substr(i, j - i), i, j + 1};
}

namespace {

/// Calls that would change the path in a way not followed here.
constexpr std::array<std::string_view, 10> unsupported{
    "STRAIGHT_PROBE", "RIGID_TAP", "START_SPEED_FEED_SYNCH", "START_CUTTER_RADIUS_COMPENSATION", "NURBS_FEED",
    "NURBS_G5_FEED",  "NURBS_G6_FEED", "SET_XY_ROTATION",    "SET_G92_OFFSET",                   "SET_ORIGIN_OFFSETS"};

class CanonicalReader {
 public:
  CanonicalReader(LineSource& source, const ReadOptions& options, MoveSink& sink)
      : source_(source), state_(source, sink, options.arc_tolerance) {}

  void run() {
    while (source_.next(line_)) {
      if (line_.find_first_not_of(" \t") == std::string_view::npos) continue;
      call_ = find_call(line_);
      if (call_.name.empty()) source_.fail(1, "is no canonical call such as STRAIGHT_FEED(...)");
      if (!execute()) return;
    }
  }

 private:
  bool execute();
  void numbers(std::size_t least, std::size_t most);
  std::string_view text() const {
    const std::size_t end = line_.find(')', call_.arguments);
    if (end == std::string_view::npos) source_.fail(line_.size() + 1, "call without its ')'");
    return line_.substr(call_.arguments, end - call_.arguments);
  }
  [[noreturn]] void bad_word(std::string_view allowed) const {
    source_.fail(call_.arguments + 1, "unknown argument of " + std::string(call_.name) + ", allowed: " + std::string(allowed));
  }
  double scaled(std::size_t argument, std::size_t axis) const {
    return value_[argument] * (axis >= 3 && axis < 6 ? 1e-3 : state_.unit);
  }
  void straight(bool rapid);
  void arc();
  void control();
  void feed();

  LineSource& source_;
  MoveState state_;
  Plane plane_ = Plane::xy;
  std::string_view line_;
  CanonicalCall call_;
  std::array<double, 10> value_{};
  std::size_t count_ = 0;
};

void CanonicalReader::numbers(std::size_t least, std::size_t most) {
  const char* const begin = line_.data();
  const char* const end = begin + line_.size();
  const char* p = begin + call_.arguments;
  const auto column = [&] { return static_cast<std::size_t>(p - begin) + 1; };
  const auto blanks = [&] {
    while (p != end && (*p == ' ' || *p == '\t')) ++p;
  };
  count_ = 0;
  for (;;) {
    blanks();
    if (count_ == most) source_.fail(column(), "more than " + std::to_string(most) + " arguments");
    if (!read_number(p, end, value_[count_])) source_.fail(column(), "not a number from -1e12 to 1e12");
    ++count_;
    blanks();
    if (p == end || (*p != ',' && *p != ')')) source_.fail(column(), "',' or ')' expected");
    if (*p++ == ')') break;
  }
  if (count_ < least) source_.fail(column() - 1, "fewer than " + std::to_string(least) + " arguments");
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
    if (unit == "CANON_UNITS_MM") state_.unit = 1e-3;
    else if (unit == "CANON_UNITS_INCHES") state_.unit = 0.0254;
    else bad_word("CANON_UNITS_MM, CANON_UNITS_INCHES");
    state_.feed *= old / state_.unit;
  } else if (name == "SELECT_PLANE") {
    const std::string_view plane = text();
    if (plane == "CANON_PLANE_XY") plane_ = Plane::xy;
    else if (plane == "CANON_PLANE_XZ") plane_ = Plane::zx;
    else if (plane == "CANON_PLANE_YZ") plane_ = Plane::yz;
    else bad_word("CANON_PLANE_XY, CANON_PLANE_XZ, CANON_PLANE_YZ");
  } else if (name == "SET_MOTION_CONTROL_MODE") {
    control();
  } else if (name == "DWELL") {
    numbers(1, 1);
    if (value_[0] < 0.0) source_.fail(call_.arguments + 1, "a dwell cannot be negative");
    state_.stop(value_[0]);
  } else if (name == "PROGRAM_STOP" || name == "OPTIONAL_PROGRAM_STOP") {
    state_.stop(0.0);
  } else if (name == "PROGRAM_END") {
    return false;
  } else if (name == "SET_G5X_OFFSET") {
    numbers(2, 10);
    if (std::any_of(value_.begin() + 1, value_.begin() + static_cast<std::ptrdiff_t>(count_), [](double v) { return v != 0.0; })) {
      source_.fail(call_.column + 1, "offsets other than 0 are not supported");
    }
  } else if (name == "SET_FEED_MODE") {
    numbers(1, 2);
    if (value_[0] != 0.0) source_.fail(call_.arguments + 1, "only feed per minute (mode 0) is supported");
  } else if (std::find(unsupported.begin(), unsupported.end(), name) != unsupported.end()) {
    const bool harmless = name == "SET_XY_ROTATION" || name == "SET_G92_OFFSET" || name == "SET_ORIGIN_OFFSETS";
    if (harmless) numbers(1, 10);
    if (!harmless || std::any_of(value_.begin(), value_.begin() + static_cast<std::ptrdiff_t>(count_), [](double v) { return v != 0.0; })) {
      source_.fail(call_.column + 1, std::string(name) + (harmless ? " other than 0" : "") + " is not supported");
    }
  }
  return true;
}

void CanonicalReader::feed() {
  numbers(1, 1);
  if (value_[0] < 0.0) source_.fail(call_.arguments + 1, "a feed cannot be negative");
  state_.feed = value_[0];  // 0 is what an interpreter prints before the first F word
}

void CanonicalReader::straight(bool rapid) {
  numbers(3, program_axis_count);
  ProgramPoint to = state_.position;
  for (std::size_t a = 0; a < count_; ++a) to[a] = scaled(a, a);
  state_.straight(to, rapid, call_.column + 1);
}

void CanonicalReader::arc() {
  numbers(6, 9);
  Arc arc;
  arc.to = state_.position;
  const std::size_t first = MoveState::first_axis(plane_), second = MoveState::second_axis(plane_);
  const std::size_t normal = 3 - first - second;
  arc.to[first] = scaled(0, first);
  arc.to[second] = scaled(1, second);
  arc.center_first = scaled(2, first);
  arc.center_second = scaled(3, second);
  arc.to[normal] = scaled(5, normal);
  for (std::size_t a = 6; a < count_; ++a) arc.to[a - 3] = scaled(a, a - 3);
  const double turns = value_[4];
  if (turns == 0.0 || turns != std::floor(turns) || std::abs(turns) > 1e6) {
    source_.fail(call_.arguments + 1, "the fifth argument of an arc is its number of turns, positive counterclockwise");
  }
  state_.arc(arc, turns < 0.0, static_cast<int>(std::abs(turns)), nullptr, plane_, call_.column + 1);
}

void CanonicalReader::control() {
  const std::string_view arguments = text();
  const std::size_t comma = arguments.find(',');
  const std::string_view mode = arguments.substr(0, comma);
  if (mode == "CANON_EXACT_STOP") state_.control = PathControl::exact_stop;
  else if (mode == "CANON_EXACT_PATH") state_.control = PathControl::exact_path;
  else if (mode == "CANON_CONTINUOUS") state_.control = PathControl::blend;
  else bad_word("CANON_EXACT_STOP, CANON_EXACT_PATH, CANON_CONTINUOUS");
  if (state_.control != PathControl::blend) return;
  state_.tolerance = -1.0;
  if (comma == std::string_view::npos) return;
  call_.arguments += comma + 1;
  numbers(1, 1);
  if (value_[0] > 0.0) state_.tolerance = value_[0] * state_.unit;  // 0 stands for G64 without P
}

}  // namespace

void read_canonical(LineSource& source, const ReadOptions& options, MoveSink& sink) {
  CanonicalReader(source, options, sink).run();
}

}  // namespace accdec
