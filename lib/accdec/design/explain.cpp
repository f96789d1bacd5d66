#include <algorithm>
#include <map>
#include <set>
#include <stdexcept>
#include <string_view>
#include <tuple>

#include <accdec/design.hpp>
#include <accdec/design/explain_solve.hpp>
#include <accdec/machine/response.hpp>

namespace accdec {
namespace {

class GainSearch {
 public:
  GainSearch(const Task& task, ExplainSolver& solve, Explanation& explanation)
      : task_(task), solve_(solve), out_(explanation) {
    for (const LimitUse& use : out_.base.limits) {
      if (of_mode(use.kind)) continue;
      for (const std::string_view corner : {std::string_view(use.corner), std::string_view()}) {
        double& most = most_used_[{use.kind, use.axis, corner}];
        most = std::max(most, use.utilisation);
      }
    }
  }

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
    solve_.expect(std::max(0, static_cast<int>(rooms.size()) - static_cast<int>(little.size())) + 2);

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
    if (!of_mode(*lever.kind)) {
      const auto found = most_used_.find({*lever.kind, lever.axis, lever.corner});
      return found == most_used_.end() ? most : found->second;
    }
    for (const LimitUse& use : out_.base.limits) {
      if (lever.concerns(use)) most = std::max(most, use.utilisation);
    }
    return most;
  }

  /// More room for some limits that was proved to gain nothing; where nothing is proved, that gained nothing.
  struct WithoutGain {
    std::set<std::string> levers;  ///< by their names
    double at_most = 0.0;          ///< s
  };

  /// More room for a larger set of limits that gained nothing. If that is proved, this set gains nothing either,
  /// because a design that holds with less room also holds with more.
  const WithoutGain* superset_without_gain(const Room& room) const {
    for (const WithoutGain& larger : without_gain_) {
      if (std::all_of(room.levers.begin(), room.levers.end(),
                      [&](const Lever& lever) { return larger.levers.contains(lever.name); }))
        return &larger;
    }
    return nullptr;
  }

  void settle(const Room& room) {
    if (solve_.cancelled()) {
      out_.complete = false;
      return;
    }
    const WithoutGain* nothing = superset_without_gain(room);
    Gain gain;
    gain.room = room;
    // The design found also holds with more room.
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
    if (gain.solved && gain.gain == 0.0 && (gain.proved() || out_.shared > 0.0)) {
      WithoutGain& without = without_gain_.emplace_back(WithoutGain{{}, gain.at_most});
      for (const Lever& lever : room.levers) without.levers.insert(lever.name);
    }
    out_.gains.push_back(std::move(gain));
  }

  const Task& task_;
  ExplainSolver& solve_;
  Explanation& out_;
  std::vector<WithoutGain> without_gain_;
  std::map<std::tuple<LimitKind, std::string_view, std::string_view>, double> most_used_;  // by axis and corner; ""
                                                                                           // means all
};

}  // namespace

Explanation explain_task(const Task& task, const ExplainOptions& options) {
  if (!(options.share > 0.0 && options.share < 1.0))
    throw std::invalid_argument("the share of more room must be between 0 and 1");
  Explanation explanation;
  explanation.share = options.share;
  const bool unproved = !task.filter && !task.settings && !Response(task.machine, task.sample_period).common();
  ExplainSolver solve(options, explanation, unproved);
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
