#include <algorithm>
#include <cmath>

#include <accdec/design/explain_solve.hpp>

namespace accdec {
namespace {

/// The next number of four digits, away from the task's value, so that the printed number is the one that was tried.
double outward(const Lever& lever, double value) {
  if (lever.whole || value == lever.value || value == lever.end) return value;
  const double printed = value * lever.per_si;
  if (printed == 0.0 || !std::isfinite(printed)) return value;
  // A power of ten below 1 has no exact double. Dividing by 1000 instead of multiplying by 0.001 gives the value that
  // is read from the printed digits.
  const int digits = 3 - static_cast<int>(std::floor(std::log10(std::abs(printed))));
  const double power = std::pow(10.0, std::abs(digits)), steps = digits >= 0 ? printed * power : printed / power;
  const double rounded = lever.upper ? std::ceil(steps - 1e-6) : std::floor(steps + 1e-6);
  const double back = (digits >= 0 ? rounded / power : rounded * power) / lever.per_si;
  return lever.upper ? std::min(back, lever.end) : std::max(back, lever.end);
}

class RemedySearch {
 public:
  RemedySearch(const Task& task, ExplainSolver& solve) : task_(task), solve_(solve) {}

  Remedy operator()(const Room& room) {
    Remedy remedy;
    remedy.room = room;
    const Solved everything = solve_(room.all_given_to(task_), true);
    if (!everything.designed) {
      remedy.help = everything.refuted ? Remedy::Help::no : Remedy::Help::unknown;
      return remedy;
    }
    double too_little = 0.0, enough = first_step(room);
    bool refuted = true;
    // The loop ends, because with every lever at its end the task has a design.
    while (!solve_.cancelled() && !at_end(room, enough) && !tried(room, enough, refuted)) {
      too_little = enough;
      enough *= 2.0;
    }
    while (!solve_.cancelled() && enough - too_little > precision(room, enough)) {
      const double middle = 0.5 * (too_little + enough);
      const bool found = tried(room, middle, refuted);
      (found ? enough : too_little) = middle;
      // A question not settled in its time would take as long again nearby.
      if (!found && !refuted) break;
    }
    if (solve_.cancelled()) return remedy;
    finish(remedy, enough, refuted);
    return remedy;
  }

 private:
  static double first_step(const Room& room) {
    return room.levers.front().whole ? 1.0 / room.levers.front().scale : 10.0 * remedy_tolerance;
  }
  static double precision(const Room& room, double enough) {
    // Whole numbers: there is no step between two neighbours.
    if (room.levers.size() == 1 && room.levers.front().whole) return 1.5 / room.levers.front().scale;
    return remedy_tolerance * (1.0 + enough);
  }
  static bool at_end(const Room& room, double share) {
    return share > 1e9 || std::all_of(room.levers.begin(), room.levers.end(),
                                      [=](const Lever& lever) { return lever.moved(share) == lever.end; });
  }

  bool tried(const Room& room, double share, bool& refuted) {
    const Solved solved = solve_(room.given_to(task_, share), true);
    if (!solved.designed) refuted = solved.refuted;
    return solved.designed;
  }

  /// Rounded values are tried again; if they fail, the unrounded ones count.
  void finish(Remedy& remedy, double share, bool refuted) {
    Task rounded = task_;
    for (const Lever& lever : remedy.room.levers) {
      remedy.values.push_back(outward(lever, lever.moved(share)));
      lever.set(rounded, remedy.values.back());
    }
    Solved solved = solve_(rounded);
    if (!solved.designed) {
      solved = solve_(remedy.room.given_to(task_, share));
      remedy.values.clear();
      for (const Lever& lever : remedy.room.levers) remedy.values.push_back(lever.moved(share));
    }
    if (!solved.designed) return;
    remedy.help = Remedy::Help::yes;
    remedy.share = share;
    remedy.smallest = refuted;
    remedy.objective = solved.result.objective();
  }

  const Task& task_;
  ExplainSolver& solve_;
};

}  // namespace

void find_remedies(const Task& task, ExplainSolver& solve, Explanation& explanation) {
  const std::vector<Lever> limits = limit_levers(task);
  std::vector<Room> rooms = rooms_of(limits);
  for (Room& room : other_rooms(task)) rooms.push_back(std::move(room));
  if (limits.size() > 1) rooms.push_back({"all limits together", "", limits});
  // About twelve solves if a change helps, one if it does not.
  solve.expect(6 * static_cast<int>(rooms.size()));
  RemedySearch search(task, solve);
  for (const Room& room : rooms) {
    if (solve.cancelled()) break;
    explanation.remedies.push_back(search(room));
  }
  if (solve.cancelled()) explanation.complete = false;
  const auto rank = [](const Remedy& r) { return r.help == Remedy::Help::yes ? r.share : unlimited; };
  std::stable_sort(explanation.remedies.begin(), explanation.remedies.end(),
                   [&](const Remedy& a, const Remedy& b) { return rank(a) < rank(b); });
}

}  // namespace accdec
