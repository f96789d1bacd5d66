#include <algorithm>
#include <cmath>
#include <limits>

#include <accdec/exact/joint.hpp>

namespace accdec::exact {

Joint::Joint(const Task& task, Search& designs, int least, std::function<bool()> stop)
    : task_(task),
      designs_(designs),
      stop_(stop),
      prover_(task, stop, BoxKind::together),
      wide_(task, stop, BoxKind::window),
      cost_(cost_of(task)),
      least_(std::max({least, task.design.order_min, 0})),
      short_(std::min(task.design.order_max, std::max(least_ + least_ / 4 + 2, designs.best->filter.order()))),
      undecided_(infinity) {
  window_.order = 2 * least_ + 2;
  for (std::size_t j = 0; j < task.corners.size(); ++j) {
    window_.at.push_back((window_.order + designs.best->delays[j] + 1) / 2);
    if (task.corners[j].error_max) window_.anchors.push_back(static_cast<int>(j));
  }
  const LimitModel model(task);
  sees_all_ = model.convex();
  std::sort(window_.anchors.begin(), window_.anchors.end(), [&](int a, int b) {
    return model.error_bound(static_cast<std::size_t>(a)) < model.error_bound(static_cast<std::size_t>(b));
  });
  wide_.look_through(window_);
  nodes_.push_back(root_node(task));
}

Joint::Node Joint::root_node(const Task& task) {
  Node root;
  for (const TaskCorner& c : task.corners) {
    root.d1.push_back(c.delay.value_or(0));
    root.d2.push_back(c.delay.value_or(task.design.order_max + 2));
  }
  root.n1 = std::max(task.design.order_min, 0);
  root.n2 = task.design.order_max;
  return root;
}

double Joint::cost(const Node& node) const {
  return cost_(node.n1, node.d1);
}

/// The largest order with which a design of the node can be shorter than the target, -1: none; cuts delays that cannot.
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
    // The most that the target leaves of this delay.
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

void Joint::share() {
  if (prover_.best && prover_.best->value < target()) designs_.best = prover_.best;
  prover_.best = designs_.best;
}

/// Short filters first, for what is learned there mostly holds for long ones, too; but not for ever.
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
    single_corner(next_corner_);
    if (stop_()) return State::stopped;
    ++next_corner_;
    return State::going_on;
  }
  if (!branched_) branch();
  std::priority_queue<Open>* const group = next();
  if (group == nullptr) return undecided_ < target() * (1.0 - 1e-9) ? State::open : State::proved;
  const Open top = group->top();
  group->pop();
  const long before = linear_programs();
  const State state = work_on(top.node, top.bound);
  spent_[group - open_] += linear_programs() - before;
  return state;
}

Joint::State Joint::work_on(int at, double before) {
  for (;;) {
    if (stop_()) {
      push(at, 0.0);
      return State::stopped;
    }
    Node cut = node(at);
    const int order = order_left(cut, target());
    if (order < node(at).n1) return State::going_on;
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
      return State::going_on;
    }
    if (chosen >= 0) {
      const auto& delays = lemmas_[static_cast<std::size_t>(chosen)].delays;
      const int delay =
          std::find_if(delays.begin(), delays.end(), [&](const auto& d) { return d.corner == corner; })->delay;
      if (verdict == Verdict::violated && later(best)) return State::going_on;
      split(at, corner, delay);
      const int first = node(at).first, second = node(at).second;
      if (verdict == Verdict::violated) {
        push(first, 0.0);
        push(second, 0.0);
        return State::going_on;
      }
      node(first).lemma = chosen;
      at = second;
      continue;
    }
    if (later(0.0)) return State::going_on;
    if (extend(at, order)) continue;
    const State state = check(at, order);
    if (state == State::stopped) push(at, 0.0);
    if (state != State::going_on) return state == State::open ? State::going_on : state;
  }
}

/// A lemma that would say something of the node if it held for longer filters: most do.
bool Joint::extend(int at, int order) {
  const bool wide = order > short_;
  for (;;) {
    std::size_t chosen = lemmas_.size();
    double best = -1.0;
    for (std::size_t l = 0; l < lemmas_.size(); ++l) {
      int open_corner = -1;
      double increase = 0.0;
      if (lemmas_[l].order >= order || fails_[l] <= order) continue;
      if (judge(lemmas_[l], node(at), &open_corner, &increase) == Verdict::satisfied) continue;
      if (increase > best) best = increase, chosen = l;
    }
    if (chosen == lemmas_.size() || stop_()) return false;
    std::vector<int> most(task_.corners.size(), -1);
    for (const auto& [j, delay] : lemmas_[chosen].delays) most[static_cast<std::size_t>(j)] = delay;
    std::vector<proof::Node> tree;
    const long budget = 5000 + 30 * static_cast<long>(lemmas_[chosen].tree.size());
    if (refutes(wide, order, most, budget, tree)) {
      lemmas_[chosen] = lemma(wide, order, most, std::move(tree));
      return true;
    }
    fails_[chosen] = wide ? short_ + 1 : order;
  }
}

/// Whether the node's least delays hold together; a lemma or a better design comes of it.
Joint::State Joint::check(int at, int order) {
  const std::vector<int> d1 = node(at).d1;
  const double before = target();
  std::vector<proof::Node> tree;
  if (order > short_ && refutes(true, order, d1, std::numeric_limits<long>::max() / 2, tree)) {
    learn(node(at), true, order, std::move(tree));
    return State::going_on;
  }
  share();
  Search::Together answer = prover_.refute_together(order, d1, std::numeric_limits<long>::max() / 2);
  share();
  if (answer.refuted) {
    learn(node(at), false, order, std::move(answer.tree));
    return State::going_on;
  }
  if (target() < before * (1.0 - 1e-12)) return State::going_on;
  if (stop_()) return State::stopped;
  undecided_ = std::min(undecided_, cost(node(at)));
  return State::open;
}

}  // namespace accdec::exact
