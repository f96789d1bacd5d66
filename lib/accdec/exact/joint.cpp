#include <algorithm>
#include <cmath>
#include <limits>

#include <accdec/exact/joint_prover.hpp>
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

Joint::Joint(const Task& task, Search& designs, int least, std::function<bool()> stop)
    : task_(task),
      designs_(designs),
      stop_(stop),
      cost_(cost_of(task)),
      least_(std::max({least, task.design.order_min, 0})),
      short_(std::min(task.design.order_max, std::max(least_ + least_ / 4 + 2, designs.best->filter.order()))),
      undecided_(infinity) {
  window_.order = 2 * least_ + 2;
  const int later = static_cast<int>(std::lround(ServoRamps(task).in(0)));
  for (std::size_t j = 0; j < task.corners.size(); ++j) {
    // Behind a response, as much later as its mean delay.
    window_.at.push_back((window_.order + designs.best->delays[j] + 1) / 2 + later);
    if (task.corners[j].error_max) window_.anchors.push_back(static_cast<int>(j));
  }
  const LimitModel model(task);
  sees_all_ = model.convex();
  std::sort(window_.anchors.begin(), window_.anchors.end(), [&](int a, int b) {
    return model.error_bound(static_cast<std::size_t>(a)) < model.error_bound(static_cast<std::size_t>(b));
  });
  for (int i = 0; i < provers_for(task, std::max(short_, window_.order)); ++i)
    provers_.push_back(std::make_unique<Prover>(task, stop, window_, i));
  nodes_.push_back(root_node(task));
}
Joint::~Joint() = default;

long Joint::linear_programs() const {
  long sum = 0;
  for (const auto& prover : provers_) sum += prover->linear_programs();
  return sum;
}

Joint::Node Joint::root_node(const Task& task) {
  Node root;
  for (const TaskCorner& c : task.corners) {
    root.d1.push_back(c.delay.value_or(0));
    root.d2.push_back(c.delay.value_or(task.design.order_max + settling + ServoRamps(task).longer()));
  }
  root.n1 = std::max(task.design.order_min, 0);
  root.n2 = task.design.order_max;
  return root;
}

double Joint::cost(const Node& node) const {
  return cost_(node.n1, node.d1);
}

/// The largest order of a design in the node that is shorter than the target; -1: none. Cuts delays that no such design
/// can have.
int Joint::order_left(Node& node, double target) const {
  Box box;
  for (std::size_t j = 0; j < node.d1.size(); ++j) box.corners.push_back({node.d1[j], node.d2[j], 0, 0});
  box.order_least = node.n1;
  box.order_most = node.n2;
  if (!tighten(task_, target, box)) return -1;
  for (std::size_t j = 0; j < node.d1.size(); ++j) node.d2[j] = box.corners[j].d2;
  return box.order;
}

Joint::Verdict Joint::judge(const Lemma& lemma, const Node& node, int* open_corner, double* increase) const {
  int open = 0;
  double least = infinity, most = -1.0;
  for (const auto& [j, delay] : lemma.delays) {
    const auto i = static_cast<std::size_t>(j);
    if (node.d1[i] > delay) return Verdict::satisfied;
    // The largest delay that the target allows here.
    const double more = cost_.delay[i] * (delay + 1 - node.d1[i]);
    if (node.d2[i] <= delay) continue;
    ++open;
    least = std::min(least, more);
    if (more > most) most = more, *open_corner = j;
  }
  *increase = least;
  return open == 0 ? Verdict::closed : open == 1 ? Verdict::unit : Verdict::violated;
}

void Joint::push(int index, double increase) {
  const Node& n = node(index);
  open_[n.n1 > short_ ? 1 : 0].push({cost(n) + increase, index});
}

void Joint::split(int index, int corner, int at) {
  Node first, second;
  Node& whole = node(index);
  first.d1 = second.d1 = std::move(whole.d1);
  first.d2 = second.d2 = std::move(whole.d2);
  first.n1 = second.n1 = whole.n1;
  first.n2 = second.n2 = whole.n2;
  whole.d1.clear(), whole.d2.clear();
  if (corner < 0) {
    first.n2 = at, second.n1 = at + 1;
  } else {
    first.d2[static_cast<std::size_t>(corner)] = at;
    second.d1[static_cast<std::size_t>(corner)] = at + 1;
  }
  whole.corner = corner;
  whole.at = at;
  whole.first = static_cast<int>(nodes_.size());
  whole.second = whole.first + 1;
  nodes_.push_back(std::move(first));
  nodes_.push_back(std::move(second));
}

double Joint::bound() const {
  double least = std::min(undecided_, target());
  if (!branched_) return std::min(least, cost(nodes_[static_cast<std::size_t>(tip_)]));
  for (const auto& group : open_)
    if (!group.empty()) least = std::min(least, group.top().bound);
  return least;
}

void Joint::add(Lemma lemma) {
  lemmas_.push_back(std::move(lemma));
  fails_.push_back(std::numeric_limits<int>::max());
}

/// Gives the best design to all provers.
void Joint::share() {
  for (const auto& prover : provers_) {
    for (const bool wide : {false, true}) {
      const auto& best = prover->of(wide).best;
      if (best && best->value < target()) designs_.best = best;
    }
  }
  for (const auto& prover : provers_) prover->some.best = prover->any.best = designs_.best;
}

/// Short filters come first, because lemmas learned there usually hold for long filters too. But long ones also get a
/// share.
std::priority_queue<Joint::Open>* Joint::next() {
  const double enough = target() * (1.0 - 1e-9);
  const auto open = [&](const std::priority_queue<Open>& group) {
    return !group.empty() && group.top().bound < enough;
  };
  if (!open(open_[0])) return open(open_[1]) ? &open_[1] : nullptr;
  const bool other = open(open_[1]) && open_[1].top().bound < open_[0].top().bound && 3 * spent_[1] < spent_[0];
  return &open_[other ? 1 : 0];
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
  std::vector<Work> works = next_works();
  if (works.empty() && !stop_()) return undecided_ < target() * (1.0 - 1e-9) ? State::open : State::proved;
  share();
  side_by_side(works.size(), threads_, [&](std::size_t i) { work_on(*provers_[i], works[i]); });
  const std::size_t known = lemmas_.size();
  for (Work& work : works) join(work, known);
  share();
  return stop_() ? State::stopped : State::going_on;
}

/// Picks nodes that no lemma settles, one for every prover.
std::vector<Joint::Work> Joint::next_works() {
  std::vector<Work> works;
  while (works.size() < provers_.size() && !stop_()) {
    std::priority_queue<Open>* const group = next();
    if (group == nullptr) break;
    const Open top = group->top();
    group->pop();
    auto work = settle(top.node, top.bound);
    if (!work) continue;
    work->group = static_cast<int>(group - open_);
    works.push_back(std::move(*work));
  }
  return works;
}

/// Applies the lemmas to a node. None: the node is settled, split or put back. Otherwise: the part that they leave, for
/// filters up to an order.
std::optional<Joint::Work> Joint::settle(int at, double before) {
  for (;;) {
    Node cut = node(at);
    const int order = order_left(cut, target());
    if (order < node(at).n1) return std::nullopt;
    const auto later = [&](double increase) {
      const double now = cost(node(at)) + increase;
      const auto& group = open_[node(at).n1 > short_ ? 1 : 0];
      if (now <= before + 1e-9 || group.empty() || now <= group.top().bound) return false;
      push(at, increase);
      return true;
    };
    int chosen = -1, corner = -1;
    double best = -1.0;
    Verdict verdict = Verdict::satisfied;
    for (std::size_t l = 0; l < lemmas_.size(); ++l) {
      if (lemmas_[l].order < order) continue;
      int open_corner = -1;
      double increase = 0.0;
      const Verdict is = judge(lemmas_[l], cut, &open_corner, &increase);
      if (is == Verdict::satisfied) continue;
      if (is != Verdict::violated || increase > best) {
        best = increase, chosen = static_cast<int>(l), corner = open_corner;
        verdict = is;
      }
      if (is != Verdict::violated) break;
    }
    if (verdict == Verdict::closed) {
      node(at).lemma = chosen;
      node(at).d1.clear(), node(at).d2.clear();
      return std::nullopt;
    }
    if (chosen < 0) {
      if (later(0.0)) return std::nullopt;
      Work work;
      work.node = at, work.order = order;
      return work;
    }
    const auto& delays = lemmas_[static_cast<std::size_t>(chosen)].delays;
    const int delay =
        std::find_if(delays.begin(), delays.end(), [&](const auto& d) { return d.corner == corner; })->delay;
    if (verdict == Verdict::violated && later(best)) return std::nullopt;
    split(at, corner, delay);
    const int first = node(at).first, second = node(at).second;
    if (verdict == Verdict::violated) {
      push(first, 0.0);
      push(second, 0.0);
      return std::nullopt;
    }
    node(first).lemma = chosen;
    at = second;
  }
}

void Joint::work_on(Prover& prover, Work& work) const {
  const long before = prover.linear_programs();
  const std::size_t some = prover.some.multipliers().size(), any = prover.any.multipliers().size();
  if (!extend(prover, work)) check(prover, work);
  // Without this, what failed attempts leave behind would grow with time.
  const std::vector<proof::Node> nothing;
  const auto found = [&](bool wide) -> const auto& {
    return work.lemma && work.lemma->wide == wide ? work.lemma->tree : nothing;
  };
  prover.some.forget(some, found(false));
  prover.any.forget(any, found(true));
  work.spent = prover.linear_programs() - before;
}

/// Takes over the result of a node. @param known  lemmas there were before this step
void Joint::join(Work& work, std::size_t known) {
  spent_[work.group] += work.spent;
  for (const auto& [lemma, order] : work.failed) fails_[lemma] = order;
  if (work.lemma) {
    const Lemma& found = *work.lemma;
    if (work.extended >= 0) {
      Lemma& old = lemmas_[static_cast<std::size_t>(work.extended)];
      if (old.order < found.order) old = std::move(*work.lemma);
    } else {
      // Another prover may have found the same.
      const auto says_it = [&](const Lemma& other) {
        return other.order >= found.order &&
               std::all_of(other.delays.begin(), other.delays.end(), [&](const proof::CornerDelay& d) {
                 return std::any_of(found.delays.begin(), found.delays.end(), [&](const proof::CornerDelay& mine) {
                   return mine.corner == d.corner && mine.delay <= d.delay;
                 });
               });
      };
      if (std::none_of(lemmas_.begin() + static_cast<std::ptrdiff_t>(known), lemmas_.end(), says_it))
        add(std::move(*work.lemma));
    }
  }
  if (work.state == State::open)
    undecided_ = std::min(undecided_, cost(node(work.node)));
  else
    push(work.node, 0.0);
}

/// Extends a lemma that would settle something in the node if it held for longer filters; most lemmas do.
bool Joint::extend(Prover& prover, Work& work) const {
  const bool wide = work.order > short_;
  std::vector<char> failed(lemmas_.size(), 0);
  for (;;) {
    std::size_t chosen = lemmas_.size();
    double best = -1.0;
    for (std::size_t l = 0; l < lemmas_.size(); ++l) {
      int open_corner = -1;
      double increase = 0.0;
      if (lemmas_[l].order >= work.order || fails_[l] <= work.order || failed[l] != 0) continue;
      if (judge(lemmas_[l], node(work.node), &open_corner, &increase) == Verdict::satisfied) continue;
      if (increase > best) best = increase, chosen = l;
    }
    if (chosen == lemmas_.size() || stop_()) return false;
    std::vector<int> most(task_.corners.size(), -1);
    for (const auto& [j, delay] : lemmas_[chosen].delays) most[static_cast<std::size_t>(j)] = delay;
    std::vector<proof::Node> tree;
    const long budget = 5000 + 30 * static_cast<long>(lemmas_[chosen].tree.size());
    if (refutes(prover, wide, work.order, most, budget, tree)) {
      work.lemma = lemma(prover, wide, work.order, most, std::move(tree));
      work.extended = static_cast<int>(chosen);
      return true;
    }
    failed[chosen] = 1;
    work.failed.emplace_back(chosen, wide ? short_ + 1 : work.order);
  }
}

/// Asks whether the node's smallest delays hold together; the result is a lemma or a better design.
void Joint::check(Prover& prover, Work& work) const {
  const Node& at = node(work.node);
  const std::vector<int>& d1 = at.d1;
  constexpr long no_budget = std::numeric_limits<long>::max() / 2;
  std::vector<proof::Node> tree;
  if (refutes(prover, true, work.order, d1, no_budget, tree)) {
    work.lemma = learn(prover, at, true, work.order, std::move(tree));
    return;
  }
  Search::Together answer = prover.some.refute_together(work.order, d1, no_budget);
  if (answer.refuted) {
    work.lemma = learn(prover, at, false, work.order, std::move(answer.tree));
    return;
  }
  if (prover.some.best->value < target() * (1.0 - 1e-12)) return;
  work.state = stop_() ? State::stopped : State::open;
}

}  // namespace accdec::exact
