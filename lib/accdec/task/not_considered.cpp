#include <algorithm>

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

std::string not_considered_text(const Machine& machine) {
  std::string text;
  for (const NotConsidered what : not_considered(machine)) {
    if (!text.empty()) text += "; ";
    switch (what) {
      case NotConsidered::vibration: text += "vibration of the machine (the task has no [[mode]])"; break;
      case NotConsidered::servo: text.append("following error and feedforward of the servo, ").append(rating); break;
    }
  }
  const bool servo_given = not_considered(machine).empty() || not_considered(machine).back() != NotConsidered::servo;
  if (servo_given) text += text.empty() ? rating : std::string("; ") + rating;
  return text;
}

}  // namespace accdec
