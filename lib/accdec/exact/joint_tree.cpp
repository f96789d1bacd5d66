#include <algorithm>
#include <utility>

#include <accdec/exact/box.hpp>
#include <accdec/exact/joint_tree.hpp>
#include <accdec/exact/limit_model.hpp>
#include <accdec/exact/one_width.hpp>
#include <accdec/exact/servo_ramps.hpp>
#include <accdec/machine/limits.hpp>

namespace accdec::exact {

std::pair<JointNode, JointNode> JointNode::parts(int split_corner, int split_at) const {
  JointNode part;
  part.d1 = d1, part.d2 = d2;
  part.n1 = n1, part.n2 = n2;
  std::pair<JointNode, JointNode> both{part, std::move(part)};
  if (split_corner < 0) {
    both.first.n2 = split_at, both.second.n1 = split_at + 1;
  } else {
    both.first.d2[static_cast<std::size_t>(split_corner)] = split_at;
    both.second.d1[static_cast<std::size_t>(split_corner)] = split_at + 1;
  }
  return both;
}

JointTree::JointTree(const Task& task, int most_short)
    : task_(task), cost_(cost_of(task)), ramps_(task), most_short_(most_short), nodes_{root(task)} {
  order(nodes_.front());
}

JointNode JointTree::root(const Task& task) {
  JointNode root;
  for (const TaskCorner& c : task.corners) {
    root.d1.push_back(c.delay.value_or(0));
    root.d2.push_back(
        c.delay.value_or(task.design.order_max + settling + ServoRamps(task).longer() + width_latency(task)));
  }
  root.n1 = std::max(task.design.order_min, 0);
  root.n2 = task.design.order_max;
  return root;
}

int JointTree::order_left(JointNode& node, double target) const {
  Box box;
  for (std::size_t j = 0; j < node.d1.size(); ++j) box.corners.push_back({node.d1[j], node.d2[j], 0, 0});
  box.servo = ramps_.ideal() ? nullptr : &ramps_;
  box.order_least = node.n1;
  box.order_most = node.n2;
  if (!tighten(task_, target, box)) return -1;
  for (std::size_t j = 0; j < node.d1.size(); ++j) node.d1[j] = box.corners[j].d1, node.d2[j] = box.corners[j].d2;
  return box.order;
}

void JointTree::order(JointNode& node) const {
  if (!by_one_width(task_)) return;
  std::vector<CornerBox> corners;
  for (std::size_t j = 0; j < node.d1.size(); ++j) corners.push_back({node.d1[j], node.d2[j], 0, 0});
  order_by_width(task_, corners);
  for (std::size_t j = 0; j < node.d1.size(); ++j) node.d1[j] = corners[j].d1;
}

void JointTree::split(int index, int corner, int at) {
  JointNode& whole = (*this)[index];
  auto [first, second] = whole.parts(corner, at);
  order(first), order(second);
  whole.d1.clear(), whole.d2.clear();
  whole.corner = corner;
  whole.at = at;
  whole.first = static_cast<int>(nodes_.size());
  whole.second = whole.first + 1;
  nodes_.push_back(std::move(first));
  nodes_.push_back(std::move(second));
}

void JointTree::push(int node, double increase) {
  open_[group_of(node)].push({cost((*this)[node]) + increase, node});
}

bool JointTree::put_back(int node, double increase, double before) {
  const double now = cost((*this)[node]) + increase;
  const auto& group = open_[group_of(node)];
  if (now <= before + 1e-9 || group.empty() || now <= group.top().bound) return false;
  push(node, increase);
  return true;
}

std::optional<JointTree::Next> JointTree::take_next(double target) {
  const double enough = target * (1.0 - 1e-9);
  const auto open = [&](const std::priority_queue<Open>& group) {
    return !group.empty() && group.top().bound < enough;
  };
  if (!open(open_[0]) && !open(open_[1])) return std::nullopt;
  const bool other =
      !open(open_[0]) || (open(open_[1]) && open_[1].top().bound < open_[0].top().bound && 3 * spent_[1] < spent_[0]);
  const Open top = open_[other ? 1 : 0].top();
  open_[other ? 1 : 0].pop();
  return Next{top.bound, top.node, other ? 1 : 0};
}

double JointTree::least_bound() const {
  double least = infinity;
  for (const auto& group : open_)
    if (!group.empty()) least = std::min(least, group.top().bound);
  return least;
}

}  // namespace accdec::exact
