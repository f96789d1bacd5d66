#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include <accdec/exact/programme.hpp>
#include <accdec/exact/stop_handler.hpp>
#include <accdec/machine/utilisation.hpp>

namespace accdec::exact {
namespace {

constexpr std::size_t most_vibration_rows = 60;

/// rad inside of which cuts grow with both distances in spite of rounding
constexpr double inside = 1e-12;

}  // namespace

Programme::Programme(const LimitModel& model, int order, const std::function<bool()>& stop, double margin)
    : model_(model),
      largest_(order),
      columns_(order + 2 + (model.has_sums() ? order + 1 : 0) +
               (model.corners() > 1 ? 2 * static_cast<int>(model.corners()) : 0)),
      slack_(margin > 0.0 ? -margin : slack) {
  lp_.setLogLevel(0);
  if (const StopHandler handler(stop); stop) lp_.passInEventHandler(&handler);
  lp_.setPrimalTolerance(1e-10), lp_.setDualTolerance(1e-9);
  lp_.scaling(0);
  lp_.resize(0, columns_);
  for (int i = 0; i < columns_; ++i) {
    lp_.setColumnBounds(i, 0.0, i <= order ? model.tap_max() * (1.0 + slack_) : 1.0 + slack);
    lp_.setObjectiveCoefficient(i, 0.0);
  }
  lp_.setObjectiveCoefficient(excess(), 1.0);
  for (std::size_t j = 0; j < model.corners(); ++j) {
    if (model.cone(j)) least_ = std::max(least_, model.error_bound(j));
  }
  add_base_rows();
  base_rows_ = lp_.numberRows();
}

Filter Programme::filter(const Box& box, bool symmetric) const {
  const double* x = lp_.primalColumnSolution();
  std::vector<double> taps(static_cast<std::size_t>(box.order) + 1);
  for (std::size_t i = 0; i < taps.size(); ++i) taps[i] = std::max(0.0, x[i]);
  if (symmetric) {
    for (std::size_t i = 0; i < taps.size() / 2; ++i) {
      taps[i] = taps[taps.size() - 1 - i] = 0.5 * (taps[i] + taps[taps.size() - 1 - i]);
    }
  }
  return Filter(std::move(taps));
}

bool Programme::cut(const Filter& filter, const Box& box, double allowed) {
  bool added = cut_cones(filter, box, allowed);
  for (const RowId& id : model_.broken_blend_rows(filter, box, broken())) added |= add_sparse(id, box);
  for (const RowId& id : model_.broken_chords(filter, box, broken())) added |= add_sparse(id, box);
  return cut_vibration(filter, box) || added;
}

void Programme::start_cold() {
  lp_.allSlackBasis(true);
  vibration_.clear();
}

void Programme::soften(const std::vector<RowId>& close, const Filter& at, const Box& box) {
  lp_.setColumnBounds(excess(), 0.0, COIN_DBL_MAX);
  for (const RowId& id : close) {
    if (const auto tangent = model_.tangent(id, at, box)) add_row(*tangent, model_.row(*tangent, box), false, true);
  }
}

std::vector<double> Programme::least_infeasibility() const {
  ClpSimplex phase(lp_);
  for (int i = 0; i < columns_; ++i) phase.setObjectiveCoefficient(i, 0.0);
  for (int r = 0; r < static_cast<int>(ids_.size()); ++r) {
    const RowId& id = ids_[static_cast<std::size_t>(r)];
    if (id.kind == RowKind::cone && id.corner < 0) continue;
    for (const double side : {-1.0, 1.0}) {
      const bool bounded = side < 0.0 ? lp_.rowUpper()[r] < COIN_DBL_MAX : lp_.rowLower()[r] > -COIN_DBL_MAX;
      if (bounded) phase.addColumn(1, &r, &side, 0.0, COIN_DBL_MAX, 1.0);
    }
  }
  phase.allSlackBasis(true);
  phase.primal();
  if (phase.status() != 0) return {};
  const double* dual = phase.dualRowSolution();
  return {dual, dual + phase.numberRows()};
}

void Programme::add(const std::vector<int>& columns, const std::vector<double>& values, double low, double high,
                    const RowId& id) {
  // Clp drops entries this small by itself, and then miscounts them (an assertion in CoinPackedMatrix).
  std::vector<int> kept;
  std::vector<double> entries;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (std::abs(values[i]) > 1e-14) kept.push_back(columns[i]), entries.push_back(values[i]);
  }
  lp_.addRow(static_cast<int>(kept.size()), kept.data(), entries.data(), low, high);
  ids_.push_back(id);
}

void Programme::add_base_rows() {
  RowId none;
  none.kind = RowKind::cone;
  none.corner = -1;  // marks equations: they have no part in the proof
  std::vector<int> columns;
  std::vector<double> values;
  for (int i = 0; i <= largest_; ++i) columns.push_back(i), values.push_back(1.0);
  add(columns, values, 1.0, 1.0, none);
  if (model_.has_sums()) {
    for (int k = 1; k <= largest_ + 1; ++k) {
      if (k == 1)
        add({sum_column(1), 0}, {1.0, -1.0}, 0.0, 0.0, none);
      else
        add({sum_column(k), sum_column(k - 1), k - 1}, {1.0, -1.0, -1.0}, 0.0, 0.0, none);
    }
  }
  Box all;
  all.order = largest_;
  all.corners.resize(model_.corners());
  if (model_.jerk_max() < 1.0) {
    for (int i = 0; i <= largest_ + 1; ++i) {
      RowId id;
      id.kind = RowKind::jerk;
      id.sample = i;
      add_row(id, model_.row(id, all), true);
    }
  }
  for (const RowId& id : model_.base_force_rows(largest_)) add_row(id, model_.row(id, all), false);
}

void Programme::add_row(const RowId& id, const SparseRow& row, bool both, bool soft) {
  std::vector<int> columns;
  std::vector<double> values;
  if (soft) columns.push_back(excess()), values.push_back(-1.0);
  // Jerk in units of a tap, others of their bound: entries of the order of 1.
  const double scale = id.kind == RowKind::jerk ? model_.jerk_max() : 1.0;
  std::map<int, double> merged;
  for (const auto& [i, c] : row.taps) merged[i] += c * scale;
  for (const auto& [k, c] : row.sums) merged[sum_column(k)] += c * scale;
  for (const auto& [column, value] : merged) columns.push_back(column), values.push_back(value);
  const double bound = (1.0 + slack_) * scale;
  add(columns, values, both ? -bound : -COIN_DBL_MAX, bound - row.constant * scale, id);
}

bool Programme::add_sparse(const RowId& id, const Box& box) {
  for (std::size_t r = static_cast<std::size_t>(base_rows_); r < ids_.size(); ++r) {
    if (same_limit(ids_[r], id) && ids_[r].low == id.low && ids_[r].high == id.high) return false;
  }
  add_row(id, model_.row(id, box), false);
  return true;
}

void Programme::add_cone(std::size_t j, double angle, const Box& box) {
  const double wp = model_.weight_in(j, angle), wq = model_.weight_out(j, angle);
  std::vector<int> columns{excess()};
  std::vector<double> values{-1.0};
  for (int i = 0; i <= box.order; ++i) {
    const double c = wp * box.weight_in(j, i) + wq * box.weight_out(j, i);
    if (c != 0.0) columns.push_back(i), values.push_back(c);
  }
  RowId id;
  id.kind = RowKind::cone;
  id.corner = static_cast<int>(j);
  id.angle = angle;
  add(columns, values, -COIN_DBL_MAX, model_.error_bound(j) * (1.0 + slack_), id);
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
    for (const RowId& old : vibration_) {
      if (old.mode == id.mode && old.frequency == id.frequency && std::abs(old.angle - id.angle) < 1e-11) id.mode = -1;
    }
    if (id.mode < 0) continue;
    vibration_.push_back(id);
    add_vibration(id);
    // A zero response needs both components held.
    if (uses[m].bound < 1e-6) {
      id.angle += 0.5 * std::numbers::pi;
      vibration_.push_back(id);
      add_vibration(id);
    }
    added = true;
  }
  return added;
}

/// Vibration rows in units of their bound, so that the programme's tolerance is one relative to it.
double Programme::vibration_scale(const RowId& id) const {
  const double bound = model_.task().machine.modes[static_cast<std::size_t>(id.mode)].residual_max;
  return bound > 0.01 ? 1.0 / bound : 1.0;
}

void Programme::add_vibration(const RowId& id) {
  const double scale = vibration_scale(id);
  std::vector<int> columns;
  std::vector<double> values;
  for (int i = 0; i <= largest_; ++i)
    columns.push_back(i), values.push_back(scale * model_.vibration_coefficient(id, i));
  const double residual = model_.task().machine.modes[static_cast<std::size_t>(id.mode)].residual_max;
  const double bound = scale * residual * (1.0 + slack_);
  add(columns, values, -bound, bound, id);
}

/// Rows of the last box go; its cuts come again at their angles in the new box.
void Programme::prepare(const Box& box, bool symmetric) {
  std::vector<std::pair<std::size_t, double>> angles;
  std::vector<RowId> chords, ranges;
  std::vector<int> old;
  for (int r = base_rows_; r < lp_.numberRows(); ++r) {
    const RowId& id = ids_[static_cast<std::size_t>(r)];
    if (id.kind == RowKind::cone && id.corner >= 0 && lp_.getRowStatus(r) != ClpSimplex::basic) {
      angles.emplace_back(static_cast<std::size_t>(id.corner), id.angle);
    }
    if (id.kind == RowKind::range_cone && lp_.getRowStatus(r) != ClpSimplex::basic) ranges.push_back(id);
    if (id.kind >= RowKind::power_start && lp_.getRowStatus(r) != ClpSimplex::basic &&
        std::none_of(chords.begin(), chords.end(), [&](const RowId& c) { return same_limit(c, id); }))
      chords.push_back(id);
    old.push_back(r);
  }
  lp_.setColumnBounds(excess(), -least_, COIN_DBL_MAX);
  if (!old.empty()) lp_.deleteRows(static_cast<int>(old.size()), old.data());
  ids_.resize(static_cast<std::size_t>(base_rows_));
  for (int i = 0; i <= largest_; ++i) lp_.setColumnUpper(i, i <= box.order ? model_.tap_max() * (1.0 + slack_) : 0.0);
  if (!model_.convex()) {
    for (int k = 1; k <= largest_ + 1; ++k) {
      const auto i = static_cast<std::size_t>(k);
      const bool bounded = i < box.tube.low.size();
      lp_.setColumnBounds(sum_column(k), bounded ? box.tube.low[i] - slack : 0.0,
                          bounded ? box.tube.high[i] + slack : 1.0 + slack);
    }
  }
  for (RowId id : chords) {
    if (id.sample > model_.last_sample(id, box)) continue;
    if (!model_.single_delay(id, box)) continue;
    if (const auto chord = model_.chord(id, box)) add_row(*chord, model_.row(*chord, box), false);
  }
  if (model_.corners() > 1) prepare_ranges(box, ranges);
  if (box.only_angle) angles.clear();
  for (const auto& [j, angle] : angles) {
    const bool grows = std::cos(angle) >= 0.0 && std::cos(model_.theta(j) - angle) >= 0.0;
    if ((grows || !box.loose(j)) && !shared(j, box)) add_cone(j, angle, box);
  }
  for (std::size_t j = 0; j < box.corners.size(); ++j) {
    const bool kept = std::any_of(angles.begin(), angles.end(), [&](const auto& a) { return a.first == j; });
    if (model_.cone(j) && !kept && !shared(j, box)) add_cone(j, box.only_angle.value_or(0.5 * model_.theta(j)), box);
  }
  if (vibration_.size() > most_vibration_rows) {
    vibration_.erase(vibration_.begin(),
                     vibration_.begin() + static_cast<std::ptrdiff_t>(vibration_.size() - most_vibration_rows / 2));
  }
  for (const RowId& id : vibration_) add_vibration(id);
  if (!symmetric) return;
  RowId none;
  none.kind = RowKind::cone;
  for (int i = 0; 2 * i < box.order; ++i) add({i, box.order - i}, {1.0, -1.0}, 0.0, 0.0, none);
}

Multipliers Programme::multipliers(const double* dual, double sign, const Box& box) {
  Multipliers y;
  if (!model_.convex() && !box.tube.low.empty()) {
    // What the rows leave on a cumulative response, its own bounds have to carry.
    std::vector<double> left(static_cast<std::size_t>(columns_), 0.0);
    lp_.transposeTimes(-sign, dual, left.data());
    for (int k = 1; k <= box.order; ++k) {
      const double value = left[static_cast<std::size_t>(sum_column(k))];
      RowId id;
      id.kind = RowKind::tube;
      id.sample = k;
      id.sign = value > 0.0 ? -1 : 1;
      const auto i = static_cast<std::size_t>(k);
      const bool natural = value > 0.0 ? box.tube.low[i] == 0.0 : box.tube.high[i] == 1.0;
      if (std::abs(value) > 1e-13 && !natural) y.emplace_back(id, std::abs(value));
    }
  }
  for (std::size_t r = 0; r < ids_.size(); ++r) {
    RowId id = ids_[r];
    double value = -sign * dual[r];  // > 0: the upper side
    if (id.kind == RowKind::cone && id.corner < 0) continue;
    if (std::abs(value) < 1e-13) continue;
    if (value < 0.0) {
      value = -value;
      if (id.kind == RowKind::jerk)
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
