#include <algorithm>

#include <accdec/exact/one_width.hpp>
#include <accdec/exact/size.hpp>
#include <accdec/exact/workbench.hpp>
#include <accdec/machine/limits.hpp>

namespace accdec::exact {

Workbench::Workbench(const Task& task, std::function<bool()> stop, BoxKind kind)
    : designs(model_, stop),
      model_(task),
      draft_(model_, task.corners.size() > 1 ? std::size_t{60} : std::size_t{8}),
      stop_(std::move(stop)),
      kind_(kind) {}

long Workbench::linear_programs() const {
  return earlier_programs_ + designs.linear_programs() + (relaxation_ ? relaxation_->linear_programs() : 0);
}

Box Workbench::root() const {
  Box box;
  box.order = task().design.order_max;
  box.servo = model_.servo();
  for (const TaskCorner& corner : task().corners) {
    CornerBox b;
    // From d = N + 1 on, the legs do not overlap. Every limited difference of the acceleration adds one sample to this,
    // and a response as many as it has.
    b.d1 = corner.delay.value_or(0);
    b.d2 = corner.delay.value_or(task().design.order_max + settling + box.longer() + width_latency(task()));
    b.k2 = b.d2 + task().design.order_max + 1 + box.longer();
    b.c2 = b.k2;
    box.corners.push_back(b);
  }
  return box;
}

void Workbench::size_for(int order) {
  // Windows are of one order.
  if (relaxation_ && kind_ != BoxKind::window && order <= sized_ && 2 * order >= sized_) return;
  if (relaxation_ && order == sized_) return;
  require_room(task(), order);
  earlier_programs_ += relaxation_ ? relaxation_->linear_programs() : 0;
  relaxation_ = std::make_unique<Relaxation>(model_, order, stop_, 0.0, kind_);
  sized_ = order;
}

void Workbench::aim(double target) {
  target_ = target;
  draft_.begin();
  Box box = root();
  if (tighten(task(), target, box)) size_for(box.order);
}

bool Workbench::narrow(Box& box, proof::Node* why) const {
  if (why) *why = proof::TooLong{};
  if (box.window) return true;
  if (!tighten(task(), target_, box)) return false;
  box.end_samples();
  for (const CornerBox& b : box.corners) {
    if (b.k1 > b.k2 || b.c1 > b.c2) return false;
  }
  if (why) *why = proof::Unreachable{};
  return (model_.convex() && !box.budget) || model_.shrink(box);
}

BoxState Workbench::leave(proof::Node leaf) {
  draft_.add(std::move(leaf));
  return BoxState::closed;
}

BoxState Workbench::close_by(int multipliers) {
  draft_.close_by(multipliers);
  return BoxState::closed;
}

}  // namespace accdec::exact
