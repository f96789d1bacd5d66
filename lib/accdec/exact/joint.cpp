#include <algorithm>
#include <cmath>

#include <accdec/exact/joint.hpp>
#include <accdec/exact/limit_model.hpp>
#include <accdec/exact/servo_ramps.hpp>
#include <accdec/exact/size.hpp>
#include <accdec/files/side_by_side.hpp>
#include <accdec/machine/limits.hpp>

namespace accdec::exact {

namespace {

/// Number of nodes worked on at a time, and so the largest useful number of threads. It does not depend on the threads
/// there are, so that the proof is always the same. It is smaller where the linear programs are large.
constexpr int most_provers = 4;
constexpr double bytes_of_provers = 2e9;

int provers_for(const Task& task, int order) {
  const double each = 2.0 * linear_program_bytes(task, order);
  return static_cast<int>(std::clamp(bytes_of_provers / each, 1.0, 1.0 * most_provers));
}

}  // namespace

Joint::Joint(const Task& task, Designs& designs, int least, std::function<bool()> stop)
    : task_(task),
      designs_(designs),
      stop_(stop),
      least_(std::max({least, task.design.order_min, 0})),
      tree_(task, std::min(task.design.order_max, std::max(least_ + least_ / 4 + 2, designs.best->filter.order()))),
      lemmas_(task),
      undecided_(infinity) {
  window_.order = 2 * least_ + 2;
  const int later = static_cast<int>(std::lround(ServoRamps(task).in(0)));
  for (std::size_t j = 0; j < task.corners.size(); ++j) {
    // Behind a response, as much later as its mean delay.
    window_.at.push_back((window_.order + designs.best->delays[j] + 1) / 2 + later);
    if (task.corners[j].error_max) window_.anchors.push_back(static_cast<int>(j));
  }
  const LimitModel model(task);
  std::sort(window_.anchors.begin(), window_.anchors.end(), [&](int a, int b) {
    return model.error_bound(static_cast<std::size_t>(a)) < model.error_bound(static_cast<std::size_t>(b));
  });
  for (int i = 0; i < provers_for(task, std::max(tree_.most_short(), window_.order)); ++i)
    provers_.push_back(std::make_unique<LemmaProver>(task, stop, window_, i));
}

long Joint::linear_programs() const {
  long sum = 0;
  for (const auto& prover : provers_) sum += prover->linear_programs();
  return sum;
}

double Joint::bound() const {
  const double least = std::min(undecided_, target());
  return std::min(least, branched_ ? tree_.least_bound() : tree_.cost(tree_[tip_]));
}

/// Gives the best design to all provers.
void Joint::share() {
  for (const auto& prover : provers_) {
    for (const bool wide : {false, true}) {
      const auto& best = prover->of(wide).best();
      if (best && best->value < target()) designs_.best = best;
    }
  }
  for (const auto& prover : provers_) prover->of(false).best() = prover->of(true).best() = designs_.best;
}

Joint::State Joint::step() {
  if (stop_()) return State::stopped;
  if (!begun_) {
    begin();
    return begun_ ? State::going_on : State::stopped;
  }
  if (next_corner_ < task_.corners.size()) {
    first_lemmas();
    return stop_() ? State::stopped : State::going_on;
  }
  if (!branched_) branch();
  std::vector<JointWork> works = next_works();
  if (works.empty() && !stop_()) return undecided_ < target() * (1.0 - 1e-9) ? State::open : State::proved;
  share();
  const double shortest = target();
  side_by_side(works.size(), threads_,
               [&](std::size_t i) { provers_[i]->work_on(works[i], tree_, lemmas_, shortest); });
  const std::size_t known = lemmas_.size();
  for (JointWork& work : works) join(work, known);
  share();
  return stop_() ? State::stopped : State::going_on;
}

/// Picks nodes that no lemma settles, one for every prover.
std::vector<JointWork> Joint::next_works() {
  std::vector<JointWork> works;
  while (works.size() < provers_.size() && !stop_()) {
    const auto next = tree_.take_next(target());
    if (!next) break;
    if (auto work = settle(*next)) works.push_back(std::move(*work));
  }
  return works;
}

/// Applies the lemmas to a node. None: the node is settled, split or put back. Otherwise: the part that they leave, for
/// filters up to an order.
std::optional<JointWork> Joint::settle(const JointTree::Next& next) {
  using Verdict = JointLemmas::Verdict;
  for (int at = next.node;;) {
    JointNode cut = tree_[at];
    const int order = tree_.order_left(cut, target());
    if (order < tree_[at].n1) return std::nullopt;
    int chosen = -1;
    double best = -1.0;
    JointLemmas::Judgement judgement;
    for (std::size_t l = 0; l < lemmas_.size(); ++l) {
      if (lemmas_[l].order < order) continue;
      const JointLemmas::Judgement is = lemmas_.judge(l, cut);
      if (is.verdict == Verdict::satisfied) continue;
      if (is.verdict != Verdict::violated || is.increase > best)
        best = is.increase, chosen = static_cast<int>(l), judgement = is;
      if (is.verdict != Verdict::violated) break;
    }
    if (chosen < 0) {
      if (tree_.put_back(at, 0.0, next.bound)) return std::nullopt;
      JointWork work;
      work.node = at, work.order = order, work.group = next.group;
      return work;
    }
    if (judgement.verdict == Verdict::closed) {
      tree_[at].lemma = chosen;
      tree_[at].d1.clear(), tree_[at].d2.clear();
      return std::nullopt;
    }
    if (judgement.verdict == Verdict::violated && tree_.put_back(at, best, next.bound)) return std::nullopt;
    tree_.split(at, judgement.corner, lemmas_[static_cast<std::size_t>(chosen)].delay_at(judgement.corner));
    const int first = tree_[at].first, second = tree_[at].second;
    if (judgement.verdict == Verdict::violated) {
      tree_.push(first, 0.0);
      tree_.push(second, 0.0);
      return std::nullopt;
    }
    tree_[first].lemma = chosen;
    at = second;
  }
}

/// Takes over the result of a node. @param known  lemmas there were before this step
void Joint::join(JointWork& work, std::size_t known) {
  tree_.charge(work.group, work.spent);
  for (const auto& [lemma, order] : work.failed) lemmas_.give_up(lemma, order);
  if (work.lemma && work.extended >= 0)
    lemmas_.extend(static_cast<std::size_t>(work.extended), std::move(*work.lemma));
  else if (work.lemma)
    lemmas_.add_new(std::move(*work.lemma), known);  // another prover may have found the same
  if (work.undecided)
    undecided_ = std::min(undecided_, tree_.cost(tree_[work.node]));
  else
    tree_.push(work.node, 0.0);
}

}  // namespace accdec::exact
