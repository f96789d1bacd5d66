#include <algorithm>

#include <accdec/exact/reversal.hpp>
#include <accdec/machine/limits.hpp>

namespace accdec::exact {

bool known_in(const proof::Reversal& id, const Box& box) {
  const CornerBox& c = box.corner(id.corner);
  const ReversalRange range = box.reversal(id.corner, id.axis);
  return c.d1 == c.d2 && (id.sign > 0 ? id.sample >= range.last : id.sample < range.first);
}

Box at_reversals(const LimitModel& model, const Filter& filter, Box box) {
  box.reversals.clear();
  if (!has_dry_friction(model.task().machine)) return box;
  std::optional<Filter> made;
  const Filter& motion = model.rows.motion().behind(filter, made);
  for (std::size_t j = 0; j < box.corners.size(); ++j) {
    const TaskCorner& corner = model.task().corners[j];
    const double still = still_part * std::max(corner.geometry().feed_in, corner.geometry().feed_out);
    for (std::size_t a = 0; a < model.task().machine.axes.size(); ++a) {
      const Legs v = legs(corner, a);
      if (model.task().machine.axes[a].coulomb == 0.0 || v.in * v.out >= 0.0) continue;
      const int d = box.corners[j].d1;
      const auto moves_back = [&](int k) {
        const double speed = v.in * motion.remaining(k) + v.out * motion.cumulative(k - d);
        return (v.out > 0.0 ? speed : -speed) > still;
      };
      int k = 0;
      while (k <= motion.order() + d && !moves_back(k)) ++k;
      box.reversals.push_back({static_cast<int>(j), static_cast<int>(a), k, k});
    }
  }
  return box;
}

std::optional<proof::ReversalSplit> missed_reversal(const LimitModel& model, const Filter& filter, const Box& box) {
  const Box own = at_reversals(model, filter, box);
  if (own.reversals.empty() || box.window) return std::nullopt;
  for (const proof::Row& id : model.rows.broken_blend_rows(filter, own, 1e-9)) {
    const auto* blend = std::get_if<proof::Blend>(&id);
    if (blend == nullptr || !(blend->limit == LimitKind::force || blend->limit == LimitKind::force_speed)) continue;
    const ReversalRange known = box.reversal(blend->corner, blend->axis);
    const int at = std::max(own.reversal(blend->corner, blend->axis).last, known.first);
    if (at <= blend->sample && at < known.last) return proof::ReversalSplit{blend->corner, blend->axis, at};
  }
  return std::nullopt;
}

}  // namespace accdec::exact
