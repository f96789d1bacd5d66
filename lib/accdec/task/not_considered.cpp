#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/task/not_considered.hpp>

namespace accdec {

namespace {

/// " of axes x, y"; empty if it is all axes.
std::string of_axes(const std::vector<std::string>& names, std::size_t all) {
  if (names.empty() || names.size() == all) return "";
  return fmt::format(" of {} {}", names.size() == 1 ? "axis" : "axes", fmt::join(names, ", "));
}

bool follows_by_servo(const Axis& axis) {
  return axis.servo_gain < unlimited || !axis.response_taps.empty();
}

/// Names the drives whose ratings are left out; empty if none is.
std::string unrated_text(const Machine& machine, const std::vector<std::string>& rated) {
  std::vector<std::string> names;
  for (const Axis& axis : machine.axes) {
    if (std::find(rated.begin(), rated.end(), axis.name) == rated.end()) names.push_back(axis.name);
  }
  const bool given = std::ranges::any_of(machine.axes, [](const Axis& axis) { return axis.force_rms_max < unlimited; });
  if (rated.empty())
    return given ? "thermal rating of the drives (the mean over a whole program, which `accdec program` judges)"
                 : "thermal rating of the drives";
  if (names.empty()) return "";
  return fmt::format("thermal rating of the drive{} {}", names.size() == 1 ? " of axis" : "s of axes",
                     fmt::join(names, ", "));
}

}  // namespace

std::string_view to_string(NotConsidered what) {
  switch (what) {
    case NotConsidered::vibration: return "vibration";
    case NotConsidered::servo: return "servo";
  }
  return "";
}

std::vector<NotConsidered> not_considered(const Machine& machine) {
  std::vector<NotConsidered> left_out;
  if (machine.modes.empty()) left_out.push_back(NotConsidered::vibration);
  const bool servo = std::all_of(machine.axes.begin(), machine.axes.end(), follows_by_servo);
  if (!servo || machine.axes.empty()) left_out.push_back(NotConsidered::servo);
  return left_out;
}

std::string not_considered_text(const Machine& machine, const std::vector<std::string>& rated) {
  std::vector<std::string> texts;
  bool servo = true;
  for (const NotConsidered what : not_considered(machine)) {
    switch (what) {
      case NotConsidered::vibration: texts.emplace_back("vibration of the machine (the task has no [[mode]])"); break;
      case NotConsidered::servo: servo = false; break;
    }
  }
  if (!servo) {
    std::vector<std::string> without;
    for (const Axis& axis : machine.axes) {
      if (!follows_by_servo(axis)) without.push_back(axis.name);
    }
    texts.push_back("following error and feedforward of the servo" + of_axes(without, machine.axes.size()));
  }
  if (const std::string rating = unrated_text(machine, rated); !rating.empty()) {
    if (servo)
      texts.push_back(rating);
    else
      texts.back().append(", ").append(rating);
  }
  return texts.empty() ? "nothing" : fmt::format("{}", fmt::join(texts, "; "));
}

}  // namespace accdec
