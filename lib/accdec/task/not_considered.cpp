#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/task/not_considered.hpp>

namespace accdec {

namespace {
constexpr const char* rating = "thermal rating of the drives";
}

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
  const bool servo = std::all_of(machine.axes.begin(), machine.axes.end(), [](const Axis& axis) {
    return axis.servo_gain < unlimited || !axis.response_taps.empty();
  });
  if (!servo || machine.axes.empty()) left_out.push_back(NotConsidered::servo);
  return left_out;
}

std::string not_considered_text(const Machine& machine, bool rated) {
  std::vector<std::string> texts;
  bool servo = true;
  for (const NotConsidered what : not_considered(machine)) {
    switch (what) {
      case NotConsidered::vibration: texts.emplace_back("vibration of the machine (the task has no [[mode]])"); break;
      case NotConsidered::servo: servo = false; break;
    }
  }
  if (!servo) texts.emplace_back("following error and feedforward of the servo");
  if (!rated && servo) texts.emplace_back(rating);
  if (!rated && !servo) texts.back().append(", ").append(rating);
  return texts.empty() ? "nothing" : fmt::format("{}", fmt::join(texts, "; "));
}

}  // namespace accdec
