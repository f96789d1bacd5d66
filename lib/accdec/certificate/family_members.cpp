#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/certificate/family_members.hpp>

namespace accdec {
namespace {

/// Whether a controller takes this time, samples.
bool settable(const SettableStage& stage, int samples, double period) {
  const double time = samples * period;
  const auto same = [](double a, double b) { return std::abs(a - b) <= 1e-6 * b; };
  if (!stage.length_set.empty())
    return std::any_of(stage.length_set.begin(), stage.length_set.end(), [&](double t) { return same(time, t); });
  const double step = stage.length_step > 0.0 ? stage.length_step : period;
  if (!same(time, std::max(1.0, std::round(time / step)) * step)) return false;
  return stage.length_max <= 0.0 || time <= stage.length_max * (1.0 + 1e-9);
}

/// Taps behind another moving average, not divided by its length: whole numbers stay whole.
std::vector<double> summed(const std::vector<double>& taps, int length) {
  std::vector<double> sums(taps.size() + static_cast<std::size_t>(length) - 1);
  double sum = 0.0;
  for (std::size_t i = 0; i < sums.size(); ++i) {
    if (i < taps.size()) sum += taps[i];
    if (i >= static_cast<std::size_t>(length)) sum -= taps[i - static_cast<std::size_t>(length)];
    sums[i] = sum;
  }
  return sums;
}

std::vector<double> echoed(const std::vector<double>& taps, int delay) {
  std::vector<double> both(taps.size() + static_cast<std::size_t>(delay), 0.0);
  for (std::size_t i = 0; i < taps.size(); ++i) {
    both[i] += taps[i];
    both[i + static_cast<std::size_t>(delay)] += taps[i];
  }
  return both;
}

FamilyMember member_of(std::vector<double> taps) {
  const double sum = std::accumulate(taps.begin(), taps.end(), 0.0);
  const std::size_t n = taps.size();
  FamilyMember member{std::move(taps), std::vector<double>(n + 1), std::vector<double>(n + 1),
                      std::vector<double>(n + 1), std::vector<double>(n + 1)};
  for (double& tap : member.taps) tap /= sum;
  for (std::size_t k = 0; k < n; ++k) member.gone[k + 1] = member.gone[k] + member.taps[k];
  for (std::size_t k = n; k-- > 0;) member.left[k] = member.left[k + 1] + member.taps[k];
  for (std::size_t k = n; k-- > 0;) member.way_left[k] = member.way_left[k + 1] + member.left[k + 1];
  for (std::size_t k = 1; k <= n; ++k) member.way_gone[k] = member.way_gone[k - 1] + member.gone[k];
  return member;
}

class Cascades {
 public:
  using Visit = std::function<void(const FamilyMember&, const std::string&)>;
  Cascades(const Task& task, int pairs, int order_end, const Visit& visit)
      : task_(task), pairs_(pairs), order_end_(order_end), visit_(visit) {}

  void run() { stage(0, {1.0}); }

 private:
  void stage(std::size_t s, const std::vector<double>& taps) {
    if (s == task_.settings->stages.size()) return pair(taps);
    const int room = order_end_ - static_cast<int>(taps.size());
    for (int length = 1; length - 1 <= room; ++length) {
      // One sample is a stage that is off. Stages that are alike are in any order.
      const SettableStage& stage_here = task_.settings->stages[s];
      if (length > 1 && !settable(stage_here, length, task_.sample_period)) continue;
      if (s > 0 && alike(stage_here, task_.settings->stages[s - 1]) && length > lengths_.back()) break;
      lengths_.push_back(length);
      stage(s + 1, summed(taps, length));
      lengths_.pop_back();
    }
  }

  static bool alike(const SettableStage& a, const SettableStage& b) {
    return a.length_step == b.length_step && a.length_max == b.length_max && a.length_set == b.length_set;
  }

  void pair(const std::vector<double>& taps) {
    if (pairs_ == 0) return offer(taps, 0);
    for (int delay = 1; static_cast<int>(taps.size()) - 1 + pairs_ * delay < order_end_; ++delay) {
      std::vector<double> with = taps;
      for (int p = 0; p < pairs_; ++p) with = echoed(with, delay);
      offer(with, delay);
    }
  }

  void offer(const std::vector<double>& taps, int delay) {
    const int order = static_cast<int>(taps.size()) - 1;
    if (order < task_.design.order_min || order >= order_end_) return;
    std::string words = fmt::format("averages of {} samples", fmt::join(lengths_, ", "));
    if (pairs_ > 0) words += fmt::format(" with {} pair(s) of impulses {} samples apart", pairs_, delay);
    visit_(member_of(taps), words);
  }

  const Task& task_;
  int pairs_, order_end_;
  const Visit& visit_;
  std::vector<int> lengths_;
};

/// Endless exponentials, cut off where less than 1e-4 of the step is left.
void visit_poles(const Task& task, int order_end, const Cascades::Visit& visit) {
  if (task.design.order_min <= 0 && order_end > 0) visit(member_of({1.0}), "no pole");
  for (int tau = 1; tau <= order_end; ++tau) {
    if (!settable(task.settings->stages.front(), tau, task.sample_period)) continue;
    std::vector<double> taps;
    // Less the rounding of the exponential, so that an exact 1e-4 ends here as it does by the logarithm.
    for (int i = 0; i == 0 || std::exp(-static_cast<double>(i) / tau) > 1e-4 * (1.0 + 1e-10); ++i)
      taps.push_back(std::exp(-static_cast<double>(i) / tau));
    const int order = static_cast<int>(taps.size()) - 1;
    if (order >= order_end) return;
    if (order >= task.design.order_min) visit(member_of(std::move(taps)), fmt::format("a pole of {} samples", tau));
  }
}

}  // namespace

void visit_family(const Task& task, SettingFamily family, int order_end,
                  const std::function<void(const FamilyMember&, const std::string&)>& visit) {
  order_end = std::min(order_end, task.design.order_max + 1);
  switch (family) {
    case SettingFamily::taps: return;
    case SettingFamily::averages: return Cascades(task, 0, order_end, visit).run();
    case SettingFamily::shaper: return Cascades(task, task.settings->shaper_pairs, order_end, visit).run();
    case SettingFamily::one_pole: return visit_poles(task, order_end, visit);
  }
}

}  // namespace accdec
