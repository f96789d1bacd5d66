#include <algorithm>
#include <cmath>
#include <numbers>

#include <accdec/exact/programme.hpp>

namespace accdec::exact {
namespace {

/// Inactive vibration cuts are kept up to this many: they hold for every box.
constexpr int most_vibration_rows = 60;

/// Marks equations: they have no part in the proof.
RowId equation(int order = 0) {
  RowId id;
  id.kind = RowKind::cone;
  id.corner = -1;
  id.sample = order;
  return id;
}

}  // namespace

Programme::Programme(const LimitModel& model, int order, const std::function<bool()>& stop, double margin)
    : model_(model),
      largest_(order),
      slack_(margin > 0.0 ? -margin : slack),
      stop_(stop),
      lp_(order + 2 + (model.corners() > 1 ? 2 * static_cast<int>(model.corners()) : 0)) {
  lp_.set_stop(stop);
  for (int i = 0; i <= order; ++i) lp_.set_column_bounds(i, 0.0, model.tap_max() * (1.0 + slack_));
  lp_.set_cost(excess(), 1.0);
  for (std::size_t j = 0; j < model.corners(); ++j) {
    if (model.cone(j)) least_ = std::max(least_, model.error_bound(j));
  }
  add_base_rows();
  base_rows_ = lp_.rows();
}

const LpSolution& Programme::solve() {
  if (clp_alone_) return solution_ = solve_by_clp(lp_, stop_);
  solution_.status = lp_.solve();
  if (solution_.status == DualSimplex::Status::trouble) return solution_ = solve_by_clp(lp_, stop_);
  solution_.objective = lp_.objective();
  solution_.point.assign(lp_.point().begin(), lp_.point().end());
  solution_.multipliers.assign(lp_.multipliers().begin(), lp_.multipliers().end());
  return solution_;
}

Filter Programme::filter(const Box& box, bool symmetric) const {
  std::vector<double> taps(static_cast<std::size_t>(box.order) + 1);
  for (std::size_t i = 0; i < taps.size(); ++i) taps[i] = std::max(0.0, solution_.point[i]);
  if (symmetric) {
    for (std::size_t i = 0; i < taps.size() / 2; ++i) {
      taps[i] = taps[taps.size() - 1 - i] = 0.5 * (taps[i] + taps[taps.size() - 1 - i]);
    }
  }
  return Filter(std::move(taps));
}

void Programme::start_cold() {
  while (lp_.rows() > base_rows_) lp_.remove_row(lp_.rows() - 1);
  ids_.resize(static_cast<std::size_t>(base_rows_));
  lp_.start_cold();
}

void Programme::soften(const std::vector<RowId>& close, const Filter& at, const Box& box) {
  lp_.set_column_bounds(excess(), 0.0, DualSimplex::infinity);
  for (const RowId& id : close) {
    const auto tangent = model_.tangent(id, at, box);
    if (!tangent) continue;
    draft_limit(*tangent, model_.row(*tangent, box), false, true);
    add(*tangent);
  }
}

void Programme::add(const RowId& id) {
  lp_.add_row(draft_.columns, draft_.values, draft_.low, draft_.high);
  ids_.push_back(id);
}

void Programme::add_base_rows() {
  draft_.clear();
  for (int i = 0; i <= largest_; ++i) draft_.add(i, 1.0);
  draft_.low = draft_.high = 1.0;
  add(equation());
  Box all;
  all.order = largest_;
  all.corners.resize(model_.corners());
  if (model_.jerk_max() < 1.0) {
    for (int i = 0; i <= largest_ + 1; ++i) {
      RowId id;
      id.kind = RowKind::jerk;
      id.sample = i;
      draft_limit(id, model_.row(id, all), true);
      add(id);
    }
  }
  for (const RowId& id : model_.base_force_rows(largest_)) {
    draft_limit(id, model_.row(id, all), false);
    add(id);
  }
  tube_rows_ = lp_.rows();
  if (model_.convex()) return;
  draft_.clear();
  draft_.low = 0.0, draft_.high = 1.0 + slack;
  for (int k = 1; k <= largest_ + 1; ++k) {
    draft_.add(k - 1, 1.0);
    RowId id;
    id.kind = RowKind::tube;
    id.sample = k;
    add(id);
  }
}

void Programme::draft_limit(const RowId& id, const SparseRow& row, bool both, bool soft) {
  // Jerk in units of a tap, others of their bound: entries of the order of 1.
  const double scale = id.kind == RowKind::jerk ? model_.jerk_max() : 1.0;
  on_tap_.assign(static_cast<std::size_t>(largest_) + 1, 0.0);
  for (const auto& [i, c] : row.taps) on_tap_[static_cast<std::size_t>(i)] += c * scale;
  for (const auto& [k, c] : row.sums) {
    for (int i = 0; i < k; ++i) on_tap_[static_cast<std::size_t>(i)] += c * scale;
  }
  draft_.clear();
  if (soft) draft_.add(excess(), -1.0);
  for (int i = 0; i <= largest_; ++i) {
    if (const double c = on_tap_[static_cast<std::size_t>(i)]; c != 0.0) draft_.add(i, c);
  }
  const double bound = (1.0 + slack_) * scale;
  draft_.low = both ? -bound : -DualSimplex::infinity;
  draft_.high = bound - row.constant * scale;
}

void Programme::draft_cone(const RowId& id, const Box& box) {
  const auto j = static_cast<std::size_t>(id.corner);
  const double wp = model_.weight_in(j, id.angle), wq = model_.weight_out(j, id.angle);
  draft_.clear();
  draft_.add(excess(), -1.0);
  for (int i = 0; i <= box.order; ++i) {
    const double c = wp * box.weight_in(j, i) + wq * box.weight_out(j, i);
    if (c != 0.0) draft_.add(i, c);
  }
  draft_.low = -DualSimplex::infinity;
  draft_.high = model_.error_bound(j) * (1.0 + slack_);
}

void Programme::add_cone(std::size_t j, double angle, const Box& box) {
  RowId id;
  id.kind = RowKind::cone;
  id.corner = static_cast<int>(j);
  id.angle = angle;
  draft_cone(id, box);
  add(id);
}

/// Vibration rows in units of their bound, so that the programme's tolerance is one relative to it.
double Programme::vibration_scale(const RowId& id) const {
  const double bound = model_.task().machine.modes[static_cast<std::size_t>(id.mode)].residual_max;
  return bound > 0.01 ? 1.0 / bound : 1.0;
}

void Programme::draft_vibration(const RowId& id) {
  const double scale = vibration_scale(id);
  draft_.clear();
  for (int i = 0; i <= largest_; ++i) draft_.add(i, scale * model_.vibration_coefficient(id, i));
  const double residual = model_.task().machine.modes[static_cast<std::size_t>(id.mode)].residual_max;
  draft_.high = scale * residual * (1.0 + slack_);
  draft_.low = -draft_.high;
}

void Programme::add_symmetry(const Box& box) {
  draft_.low = draft_.high = 0.0;
  for (int i = 0; 2 * i < box.order; ++i) {
    draft_.clear();
    draft_.add(i, 1.0), draft_.add(box.order - i, -1.0);
    add(equation(box.order));
  }
}

/// Gives a cut its coefficients in a new box. False: it is not worth keeping, or says nothing there.
bool Programme::carry_over(int row, const Box& box, bool symmetric) {
  RowId& id = ids_[static_cast<std::size_t>(row)];
  const bool active = lp_.active(row);
  if (id.kind == RowKind::cone && id.corner < 0) return symmetric && id.sample == box.order;
  if (id.kind == RowKind::vibration) return active || lp_.rows() - base_rows_ <= most_vibration_rows;
  if (!active && id.kind != RowKind::budget) return false;
  if (id.kind == RowKind::budget) {
    if (!box.budget) return false;
    draft_budget(box);
  } else if (id.kind == RowKind::range_cone) {
    if (!shared(static_cast<std::size_t>(id.corner), box)) return false;
    draft_range_cone(id, box);
  } else if (id.kind == RowKind::cone) {
    const auto j = static_cast<std::size_t>(id.corner);
    if (shared(j, box)) return false;
    const bool grows = std::cos(id.angle) >= 0.0 && std::cos(model_.theta(j) - id.angle) >= 0.0;
    if (!grows && box.loose(j)) return false;
    if (box.only_angle && *box.only_angle != id.angle) return false;
    draft_cone(id, box);
  } else if (id.kind >= RowKind::power_start) {
    if (id.sample > model_.last_sample(id, box) || !model_.single_delay(id, box)) return false;
    const auto chord = model_.chord(id, box);
    if (!chord) return false;
    id = *chord;
    draft_limit(id, model_.row(id, box), false);
  } else {
    const CornerBox& c = box.corners[static_cast<std::size_t>(id.corner)];
    if (c.d1 != c.d2) return false;
    const SparseRow limit = model_.row(id, box);
    if (limit.taps.empty() && limit.sums.empty()) return false;
    draft_limit(id, limit, false);
  }
  lp_.replace_row(row, draft_.columns, draft_.values, draft_.low, draft_.high);
  return true;
}

void Programme::prepare(const Box& box, bool symmetric) {
  bool symmetry = false;
  std::vector<char> has_cone(box.corners.size(), 0);
  for (int row = lp_.rows() - 1; row >= base_rows_; --row) {
    if (carry_over(row, box, symmetric)) {
      const RowId& id = ids_[static_cast<std::size_t>(row)];
      if (id.kind != RowKind::cone) continue;
      if (id.corner < 0)
        symmetry = true;
      else
        has_cone[static_cast<std::size_t>(id.corner)] = 1;
    } else {
      lp_.remove_row(row);
      ids_[static_cast<std::size_t>(row)] = ids_.back();
      ids_.pop_back();
    }
  }
  lp_.set_column_bounds(excess(), -least_, DualSimplex::infinity);
  for (int i = 0; i <= largest_; ++i)
    lp_.set_column_bounds(i, 0.0, i <= box.order ? model_.tap_max() * (1.0 + slack_) : 0.0);
  for (int k = 1; k <= largest_ + 1 && !model_.convex(); ++k) {
    const auto i = static_cast<std::size_t>(k);
    const bool bounded = i < box.tube.low.size();
    lp_.set_row_bounds(tube_rows_ + k - 1, bounded ? box.tube.low[i] - slack : 0.0,
                       bounded ? box.tube.high[i] + slack : 1.0 + slack);
  }
  if (model_.corners() > 1) prepare_ranges(box);
  for (std::size_t j = 0; j < box.corners.size(); ++j) {
    if (model_.cone(j) && has_cone[j] == 0 && !shared(j, box))
      add_cone(j, box.only_angle.value_or(0.5 * model_.theta(j)), box);
  }
  if (symmetric && !symmetry) add_symmetry(box);
}

Multipliers Programme::multipliers() const {
  Multipliers y;
  for (std::size_t r = 0; r < ids_.size(); ++r) {
    RowId id = ids_[r];
    double value = -solution_.multipliers[r];  // > 0: the upper side
    if (id.kind == RowKind::cone && id.corner < 0) continue;
    if (std::abs(value) < 1e-13) continue;
    if (value < 0.0) {
      value = -value;
      if (id.kind == RowKind::jerk || id.kind == RowKind::tube)
        id.sign = -1;
      else if (id.kind == RowKind::vibration)
        id.angle += std::numbers::pi;
      else
        continue;
    }
    if (id.kind == RowKind::jerk) value *= model_.jerk_max();
    if (id.kind == RowKind::vibration) value *= vibration_scale(id);
    y.emplace_back(id, value);
  }
  return y;
}

}  // namespace accdec::exact
