#include <algorithm>
#include <cmath>
#include <limits>

#include <accdec/exact/joint.hpp>

namespace accdec::exact {
namespace {

/// Linear programs that one attempt at a stronger lemma may take, beside as many as twice the lemma's own proof took.
constexpr long attempt = 40;

}  // namespace

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
  Node root;
  for (const TaskCorner& c : task.corners) {
    root.d1.push_back(c.delay.value_or(0));
    root.d2.push_back(c.delay.value_or(task.design.order_max + 2));
  }
  root.n1 = std::max(task.design.order_min, 0);
  root.n2 = task.design.order_max;
  nodes_.push_back(std::move(root));
}

/// The orders that no filter has.
void Joint::begin() {
  std::vector<proof::Node> tree;
  const std::vector<int> all(task_.corners.size(), -1);
  for (int none = least_ - 1; none >= node(0).n1 && none >= least_ - 3 && !stop_(); --none) {
    if (!refutes(false, none, all, 2000, tree)) continue;
    add(lemma(false, none, all, std::move(tree)));
    split(0, -1, none);
    node(1).lemma = 0;
    tip_ = 2;
    break;
  }
  begun_ = tip_ != 0 || !stop_();
}

/// From here on there are nodes of short and of long filters.
void Joint::branch() {
  branched_ = true;
  if (short_ >= task_.design.order_max || node(tip_).n1 > short_) return push(tip_, 0.0);
  split(tip_, -1, short_);
  const int first = node(tip_).first, second = node(tip_).second;
  push(first, 0.0);
  push(second, 0.0);
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

/// A lemma of one corner: the longest delay above `low` that it cannot have, by bisection. Its number; -1: none.
int Joint::longest_refuted(std::size_t j, bool wide, int low) {
  const int shorter = std::min(task_.design.order_max, least_ + least_ / 4 + 2);
  std::vector<int> most(task_.corners.size(), -1);
  std::vector<proof::Node> tree, best;
  // The best design's delay holds, if not with this order then with its own.
  int high = std::min(designs_.best->delays[j], shorter + 2);
  const long budget = wide ? 200 : std::numeric_limits<long>::max() / 2;
  while (high - low > 1 && !stop_()) {
    most[j] = low + (high - low) / 2;
    if (refutes(wide, shorter, most, budget, tree)) {
      low = most[j];
      best = std::move(tree);
    } else {
      high = most[j];
    }
  }
  if (best.empty()) return -1;
  most[j] = low;
  add(lemma(wide, shorter, most, std::move(best)));
  return static_cast<int>(lemmas_.size()) - 1;
}

/// Lemmas of one corner through a window, where a few linear programs show as much of filters of any order as many do
/// of short ones. Together they are a first bound. What a window does not see is asked of short filters.
void Joint::single_corner(std::size_t j) {
  if (task_.corners[j].delay) return;
  share();
  int low = -1;
  if (task_.corners[j].error_max) {
    const int by = longest_refuted(j, true, -1);
    if (by >= 0) {
      const proof::CornerDelay at = lemmas_[static_cast<std::size_t>(by)].delays.front();
      close_first(by, at);
      low = at.delay;
    }
  }
  if (!sees_all_) longest_refuted(j, false, low);
}

/// Splits the open node at a delay that a lemma says no filter has.
void Joint::close_first(int lemma, const proof::CornerDelay& at) {
  const Node& open = node(tip_);
  const auto j = static_cast<std::size_t>(at.corner);
  if (at.delay < open.d1[j] || at.delay >= open.d2[j]) return;
  split(tip_, at.corner, at.delay);
  node(node(tip_).first).lemma = lemma;
  tip_ = node(tip_).second;
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

/// @param wide  for filters of any order; else up to `order`
bool Joint::refutes(bool wide, int order, const std::vector<int>& most, long budget, std::vector<proof::Node>& tree) {
  Search& prover = wide ? wide_ : prover_;
  Search::Together answer = prover.refute_together(order, most, budget);
  share();
  if (answer.refuted) tree = std::move(answer.tree);
  return answer.refuted;
}

Joint::Lemma Joint::lemma(bool wide, int order, const std::vector<int>& most, std::vector<proof::Node> tree) const {
  Lemma lemma;
  lemma.wide = wide;
  lemma.order = wide ? std::numeric_limits<int>::max() : order;
  lemma.tree = std::move(tree);
  for (std::size_t j = 0; j < most.size(); ++j)
    if (most[j] >= 0) lemma.delays.push_back({static_cast<int>(j), most[j]});
  return lemma;
}

/// Of a proof that these delays do not hold together: the fewest corners and the largest delays it holds for.
void Joint::learn(const Node& node, bool wide, int order, std::vector<proof::Node> tree) {
  const Search& prover = wide ? wide_ : prover_;
  const std::vector<int>& d1 = node.d1;
  std::vector<int> most = d1;
  const std::vector<char> used = prover.corners_used(tree);
  std::vector<std::size_t> corners;
  for (std::size_t j = 0; j < most.size(); ++j) {
    if (used[j])
      corners.push_back(j);
    else
      most[j] = -1;
  }
  const long budget = attempt + static_cast<long>(tree.size());
  // Those that are cheap to raise are worth leaving out most.
  std::sort(corners.begin(), corners.end(),
            [&](std::size_t a, std::size_t b) { return cost_.delay[a] < cost_.delay[b]; });
  for (std::size_t i = 0; i < corners.size() && corners.size() > 1;) {
    const std::size_t j = corners[i];
    const int had = most[j];
    most[j] = -1;
    if (refutes(wide, order, most, budget, tree)) {
      const std::vector<char> still = prover.corners_used(tree);
      std::erase_if(corners, [&](std::size_t k) { return !still[k]; });
      for (std::size_t k = 0; k < most.size(); ++k)
        if (!still[k]) most[k] = -1;
    } else {
      most[j] = had;
      ++i;
    }
  }
  std::vector<char> stuck(most.size(), 0);
  const double room = target() - cost(node);
  while (!stop_()) {
    std::size_t lowest = most.size();
    double least = infinity;
    for (const std::size_t j : corners) {
      const double more = cost_.delay[j] * (most[j] + 1 - d1[j]);
      if (!stuck[j] && more < least && more < room && !task_.corners[j].delay) least = more, lowest = j;
    }
    if (lowest == most.size()) break;
    ++most[lowest];
    if (!refutes(wide, order, most, budget, tree)) --most[lowest], stuck[lowest] = 1;
  }
  add(lemma(wide, order, most, std::move(tree)));
}

}  // namespace accdec::exact
