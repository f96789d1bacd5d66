#include <algorithm>
#include <cmath>
#include <numbers>

#include <accdec/exact/programme.hpp>
#include <accdec/machine/utilisation.hpp>

// Rows that a solution of the programme breaks.

namespace accdec::exact {
namespace {

/// rad inside of which cuts grow with both distances in spite of rounding
constexpr double inside = 1e-12;
/// Cuts whose angles are closer than this are the same to the programme's tolerance.
constexpr double same_angle = 1e-11;

}  // namespace

bool Programme::cut(const Filter& filter, const Box& box, double allowed) {
  bool added = cut_cones(filter, box, allowed);
  for (const RowId& id : model_.broken_blend_rows(filter, box, broken())) added |= add_limit(id, box);
  for (const RowId& id : model_.broken_chords(filter, box, broken())) added |= add_limit(id, box);
  return cut_vibration(filter, box) || added;
}

bool Programme::add_limit(const RowId& id, const Box& box) {
  for (std::size_t r = static_cast<std::size_t>(base_rows_); r < ids_.size(); ++r) {
    if (same_limit(ids_[r], id) && ids_[r].low == id.low && ids_[r].high == id.high) return false;
  }
  draft_limit(id, model_.row(id, box), false);
  add(id);
  return true;
}

bool Programme::cut_cones(const Filter& filter, const Box& box, double allowed) {
  bool added = false;
  for (std::size_t j = 0; j < box.corners.size(); ++j) {
    if (!model_.cone(j) || box.only_angle) continue;
    if (shared(j, box)) {
      cut_ranges(j, filter, box, allowed, added);
      continue;
    }
    double p = 0.0, q = 0.0;
    for (int i = 0; i <= filter.order(); ++i) {
      p += filter.tap(i) * box.weight_in(j, i);
      q += filter.tap(i) * box.weight_out(j, i);
    }
    p *= model_.scale_in(j), q *= model_.scale_out(j);
    const double theta = model_.theta(j);
    double angle = std::atan2(q * std::sin(theta), p + q * std::cos(theta));
    // Within a box only cuts that grow with both distances hold.
    if (box.loose(j))
      angle = std::clamp(angle, theta - 0.5 * std::numbers::pi + inside, 0.5 * std::numbers::pi - inside);
    const double value = p * std::cos(angle) + q * std::cos(theta - angle);
    if (value <= model_.error_bound(j) * (1.0 + broken()) + 1e-13 + std::max(allowed, 0.0) * (1.0 + slack)) continue;
    RowId id;
    id.kind = RowKind::cone;
    id.corner = static_cast<int>(j);
    id.angle = angle;
    if (known_cone(id)) continue;  // the programme's own tolerance
    add_cone(j, angle, box);
    added = true;
  }
  return added;
}

bool Programme::known_cone(const RowId& id) const {
  const auto same = [](const Tangent& a, const Tangent& b) {
    return a.at == b.at && a.after == b.after && a.high == b.high;
  };
  return std::any_of(ids_.begin() + base_rows_, ids_.end(), [&](const RowId& old) {
    return old.kind == id.kind && old.corner == id.corner && std::abs(old.angle - id.angle) < same_angle &&
           same(old.in, id.in) && same(old.out, id.out);
  });
}

bool Programme::add_vibration(const RowId& id) {
  const auto same = [&](const RowId& old) {
    return old.kind == RowKind::vibration && old.mode == id.mode && old.frequency == id.frequency &&
           std::abs(old.angle - id.angle) < same_angle;
  };
  if (std::any_of(ids_.begin() + base_rows_, ids_.end(), same)) return false;
  draft_vibration(id);
  add(id);
  return true;
}

bool Programme::cut_vibration(const Filter& filter, const Box& box) {
  bool added = false;
  const double t = model_.task().sample_period;
  const auto uses = vibration_utilisation(filter, t, model_.task().machine);
  for (std::size_t m = 0; m < uses.size(); ++m) {
    if (uses[m].value <= uses[m].bound * (1.0 + broken()) + 1e-13) continue;
    RowId id;
    id.kind = RowKind::vibration;
    id.mode = static_cast<int>(m);
    id.frequency = uses[m].frequency;
    double c = 0.0, s = 0.0;
    for (int i = 0; i <= box.order; ++i) {
      const double w = 2.0 * std::numbers::pi * id.frequency * t * i;
      c += filter.tap(i) * std::cos(w);
      s += filter.tap(i) * std::sin(w);
    }
    id.angle = std::atan2(s, c);
    if (!add_vibration(id)) continue;
    added = true;
    // A zero response needs both components held.
    if (uses[m].bound >= 1e-6) continue;
    id.angle += 0.5 * std::numbers::pi;
    add_vibration(id);
  }
  return added;
}

}  // namespace accdec::exact
