#include <algorithm>
#include <stdexcept>

#include <accdec/design/explain.hpp>
#include <accdec/design/explain_solve.hpp>

namespace accdec {
namespace {

class GainSearch {
 public:
  GainSearch(const Task& task, ExplainSolver& solve, Explanation& explanation)
      : task_(task), solve_(solve), out_(explanation) {}

  void run() {
    std::vector<Lever> levers;
    for (Lever& lever : limit_levers(task_)) (lever.value == 0.0 ? out_.not_moved : levers).push_back(std::move(lever));
    const bool highest = !task_.filter && out_.base.filter->order() == task_.design.order_max;
    if (highest) levers.push_back(order_lever(task_));
    if (levers.empty()) return;
    const std::vector<Room> rooms = rooms_of(levers);
    std::vector<Lever> little;
    for (const Lever& lever : levers) {
      if (lever.kind && use_of(lever) * (1.0 + out_.share) < 1.0) little.push_back(lever);
    }
    solve_.expect(static_cast<int>(rooms.size() - little.size()) + 2);

    if (levers.size() > 1) settle({"all limits together", "", levers});
    if (little.size() > 1) settle({"little used", "", little});
    for (const Room& room : rooms) settle(room);
    std::erase_if(out_.gains, [](const Gain& g) { return g.room.name == "little used"; });
    std::stable_sort(out_.gains.begin(), out_.gains.end(),
                     [](const Gain& a, const Gain& b) { return a.gain > b.gain + 1e-9 * b.objective; });
  }

 private:
  double use_of(const Lever& lever) const {
    double most = 0.0;
    for (const LimitUse& use : out_.base.limits) {
      if (lever.concerns(use)) most = std::max(most, use.utilisation);
    }
    return most;
  }

  static bool holds_all(const Room& larger, const Room& room) {
    return std::all_of(room.levers.begin(), room.levers.end(), [&](const Lever& lever) {
      return std::any_of(larger.levers.begin(), larger.levers.end(),
                         [&](const Lever& other) { return other.name == lever.name; });
    });
  }

  /// A room for more limits that was proved to gain nothing: then neither does this one, for whatever holds the task
  /// with less room holds it with more.
  const Gain* superset_without_gain(const Room& room) const {
    for (const Gain& gain : out_.gains) {
      if (gain.solved && gain.gain == 0.0 && gain.proved() && holds_all(gain.room, room)) return &gain;
    }
    return nullptr;
  }

  void settle(const Room& room) {
    if (solve_.cancelled()) {
      out_.complete = false;
      return;
    }
    const Gain* nothing = superset_without_gain(room);
    Gain gain;
    gain.room = room;
    // The design found holds with more room as well.
    const DesignResult& base = out_.base;
    const DesignResult* best = &base;
    Solved solved;
    if (nothing != nullptr) {
      gain.at_most = nothing->at_most;
    } else {
      solved = solve_(room.given_to(task_, out_.share));
      gain.solved = true;
      if (solved.designed && solved.result.objective() < base.objective() * (1.0 - 1e-9)) best = &solved.result;
      gain.at_most = solved.bound > 0.0 ? std::max(0.0, base.objective() - solved.bound) : unlimited;
    }
    gain.objective = best->objective();
    gain.gain = base.objective() - gain.objective;
    gain.order = best->filter->order();
    for (const CornerResult& corner : best->corners) gain.delays.push_back(corner.delay);
    out_.gains.push_back(std::move(gain));
  }

  const Task& task_;
  ExplainSolver& solve_;
  Explanation& out_;
};

}  // namespace

Explanation explain_task(const Task& task, const ExplainOptions& options) {
  if (!(options.share > 0.0 && options.share < 1.0))
    throw std::invalid_argument("the share of more room must be between 0 and 1");
  Explanation explanation;
  explanation.share = options.share;
  ExplainSolver solve(options, explanation);
  Solved base = solve(task);
  explanation.base = std::move(base.result);
  if (base.designed) {
    explanation.base_proved = explanation.base.status == Status::optimal && base.bound > 0.0;
    explanation.bindings = find_bindings(explanation.base);
    GainSearch(task, solve, explanation).run();
  } else if (!solve.cancelled()) {
    explanation.base_proved = base.refuted;
    find_remedies(task, solve, explanation);
  }
  return explanation;
}

}  // namespace accdec
