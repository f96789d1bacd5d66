#include <algorithm>
#include <cmath>
#include <numbers>

#include <accdec/exact/linear_program.hpp>
#include <accdec/exact/window.hpp>

namespace accdec::exact {
namespace {

/// At most this many inactive vibration cuts are kept: they hold for every box.
constexpr int most_vibration_rows = 60;

}  // namespace

LinearProgram::LinearProgram(const LimitModel& model, int order, const std::function<bool()>& stop, double margin,
                             BoxKind kind)
    : model_(model),
      largest_(order),
      slack_(margin != 0.0 ? -margin : slack),
      stop_(stop),
      window_(kind == BoxKind::window),
      ranges_(kind == BoxKind::budget && model.corners() > 1),
      lp_(order + 2 + (ranges_ ? 2 * static_cast<int>(model.corners()) : 0)) {
  lp_.set_stop(stop);
  for (int i = 0; i <= order; ++i) lp_.set_column_bounds(i, 0.0, tap_bound(i));
  lp_.set_cost(excess(), 1.0);
  for (std::size_t j = 0; j < model.corners(); ++j) {
    if (model.cone(j)) least_ = std::max(least_, model.error_bound(j));
  }
  add_base_rows();
  base_rows_ = lp_.rows();
}

/// The end columns of a window stand for many taps.
double LinearProgram::tap_bound(int column) const {
  return window_ && (column == 0 || column == largest_) ? 1.0 : model_.rows.tap_max() * (1.0 + slack_);
}

const LpSolution& LinearProgram::solve() {
  if (clp_alone_) return solution_ = solve_by_clp(lp_.given(), stop_);
  solution_.status = lp_.solve();
  if (solution_.status == DualSimplex::Status::trouble) return solution_ = solve_by_clp(lp_.given(), stop_);
  solution_.objective = lp_.objective();
  solution_.point.assign(lp_.point().begin(), lp_.point().end());
  solution_.multipliers.assign(lp_.multipliers().begin(), lp_.multipliers().end());
  return solution_;
}

Filter LinearProgram::filter(const Box& box, bool symmetric) const {
  std::vector<double> taps(static_cast<std::size_t>(box.order) + 1);
  for (std::size_t i = 0; i < taps.size(); ++i) taps[i] = std::max(0.0, solution_.point[i]);
  if (symmetric) {
    for (std::size_t i = 0; i < taps.size() / 2; ++i) {
      taps[i] = taps[taps.size() - 1 - i] = 0.5 * (taps[i] + taps[taps.size() - 1 - i]);
    }
  }
  return Filter(std::move(taps));
}

void LinearProgram::start_cold() {
  while (lp_.rows() > base_rows_) lp_.remove_row(lp_.rows() - 1);
  ids_.resize(static_cast<std::size_t>(base_rows_));
  lp_.start_cold();
}

void LinearProgram::soften(const std::vector<Chord>& close, const Filter& at, const Box& box) {
  add_tangents(close, at, box, 0.95, true);
}

void LinearProgram::tie(const std::vector<Chord>& close, const Filter& at, const Box& box) {
  add_tangents(close, at, box, 0.0, false);
}

void LinearProgram::add_tangents(const std::vector<Chord>& close, const Filter& at, const Box& box, double least_use,
                                 bool soft) {
  lp_.set_column_bounds(excess(), 0.0, DualSimplex::infinity);
  for (const Chord& chord : close) {
    const auto tangent = model_.chords.tangent(chord, at, box, least_use);
    if (!tangent) continue;
    draft_limit(model_.chords.row(*tangent, box), 1.0, false, soft);
    add(row_of(*tangent));
  }
}

void LinearProgram::add(Id id) {
  lp_.add_row(draft_.columns, draft_.values, draft_.low, draft_.high);
  ids_.push_back(std::move(id));
}

void LinearProgram::add_base_rows() {
  draft_.clear();
  for (int i = 0; i <= largest_; ++i) draft_.add(i, 1.0);
  draft_.low = draft_.high = 1.0;
  add(Equation{});
  Box all;
  all.order = largest_;
  all.corners.resize(model_.corners());
  all.window = window_;
  // Rows of differences are in units of a tap, others in units of their bound, so that entries are of the order of 1.
  for (const RampLimit& ramp : model_.rows.ramps()) {
    const double reach = std::ldexp(1.0, ramp.differences - 1);  // of any taps from 0 to 1
    for (int i = 0; ramp.max < reach && i <= largest_ + ramp.differences; ++i) {
      const proof::TapDifference id{i, 1, ramp.kind};
      if (window_ && !inside_window(id, all)) continue;
      draft_limit(model_.rows.row(id, all), ramp.max, true);
      add(id);
    }
  }
  for (const proof::Row& id : model_.rows.base_force_rows(largest_)) {
    if (window_ && !inside_window(id, all)) continue;
    draft_limit(model_.row(id, all), 1.0, false);
    add(id);
  }
  tube_rows_ = lp_.rows();
  if (model_.convex() || window_) return;
  draft_.clear();
  draft_.low = 0.0, draft_.high = 1.0 + slack;
  for (int k = 1; k <= largest_ + 1; ++k) {
    draft_.add(k - 1, 1.0);
    add(proof::Response{k, 1});
  }
}

void LinearProgram::draft_limit(const SparseRow& row, double scale, bool both, bool soft) {
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

void LinearProgram::draft_cone(const proof::Error& id, const Box& box) {
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

void LinearProgram::add_cone(std::size_t j, double angle, const Box& box) {
  const proof::Error id{static_cast<int>(j), angle};
  draft_cone(id, box);
  add(id);
}

/// Scales vibration rows to units of their bound, so that the linear program's tolerance is relative to it.
double LinearProgram::vibration_scale(const proof::Vibration& id) const {
  const double bound = model_.task().machine.modes[static_cast<std::size_t>(id.mode)].residual_max;
  return bound > 0.01 ? 1.0 / bound : 1.0;
}

void LinearProgram::draft_vibration(const proof::Vibration& id, const Box& box) {
  const double scale = vibration_scale(id);
  draft_.clear();
  on_tap_.assign(static_cast<std::size_t>(largest_) + 1, 0.0);
  if (window_)
    add_window_vibration(model_, id, scale, on_tap_);
  else  // damping counts from the box's last tap; without, a row serves every order
    model_.rows.add_vibration(
        id, scale, id.damping > 0.0 ? std::span(on_tap_).first(static_cast<std::size_t>(box.order) + 1) : on_tap_);
  for (int i = 0; i <= largest_; ++i) draft_.add(i, on_tap_[static_cast<std::size_t>(i)]);
  const double residual = model_.task().machine.modes[static_cast<std::size_t>(id.mode)].residual_max;
  draft_.high = scale * residual * (1.0 + slack_);
  draft_.low = window_ ? -DualSimplex::infinity : -draft_.high;
}

void LinearProgram::add_symmetry(const Box& box) {
  draft_.low = draft_.high = 0.0;
  for (int i = 0; 2 * i < box.order; ++i) {
    draft_.clear();
    draft_.add(i, 1.0), draft_.add(box.order - i, -1.0);
    add(Equation{box.order});
  }
}

bool LinearProgram::redraft(const proof::Error& id, const Box& box) {
  const auto j = static_cast<std::size_t>(id.corner);
  if (shared(j, box)) return false;
  const bool grows = std::cos(id.angle) >= 0.0 && std::cos(model_.theta(j) - id.angle) >= 0.0;
  if (!grows && box.loose(j)) return false;
  if (box.only_angle && *box.only_angle != id.angle) return false;
  draft_cone(id, box);
  return true;
}

bool LinearProgram::redraft(const proof::RangeError& id, const Box& box) {
  if (!shared(static_cast<std::size_t>(id.corner), box)) return false;
  draft_range_cone(id, box);
  return true;
}

bool LinearProgram::redraft(const proof::Blend& id, const Box& box) {
  const CornerBox& c = box.corner(id.corner);
  if (c.d1 != c.d2 || (window_ && !inside_window(id, box))) return false;
  const SparseRow limit = model_.rows.row(id, box);
  if (limit.no_terms()) return false;
  draft_limit(limit, 1.0, false);
  return true;
}

bool LinearProgram::redraft(Chord& chord, const Box& box) {
  const Chords& chords = model_.chords;
  if (chord.sample > chords.last_sample(chord.family, box) || !chords.single_delay(chord.family, box)) return false;
  const auto drawn = chords.draw(chord.family, chord.sample, box);
  if (!drawn) return false;
  chord = *drawn;
  draft_limit(chords.row(chord, box), 1.0, false);
  return true;
}

/// Gives a cut its coefficients in a new box. False: it is not worth keeping, or says nothing there.
bool LinearProgram::carry_over(int row, const Box& box, bool symmetric) {
  Id& id = ids_[static_cast<std::size_t>(row)];
  const bool active = lp_.active(row);
  if (const auto* equation = std::get_if<Equation>(&id)) return symmetric && equation->order == box.order;
  if (const auto* vibration = limit_of<proof::Vibration>(id)) {
    if (!active && lp_.rows() - base_rows_ > most_vibration_rows) return false;
    if (vibration->damping == 0.0) return true;
    draft_vibration(*vibration, box);
    lp_.replace_row(row, draft_.columns, draft_.values, draft_.low, draft_.high);
    return true;
  }
  if (limit_of<proof::Budget>(id) != nullptr) {
    if (!box.budget) return false;
    draft_budget(box);
  } else if (!active) {
    return false;
  } else if (const auto* error = limit_of<proof::Error>(id)) {
    if (!redraft(*error, box)) return false;
  } else if (const auto* range = limit_of<proof::RangeError>(id)) {
    if (!redraft(*range, box)) return false;
  } else if (const auto* blend = limit_of<proof::Blend>(id)) {
    if (!redraft(*blend, box)) return false;
  } else if (auto chord = chord_of(std::get<proof::Row>(id))) {
    if (!redraft(*chord, box)) return false;
    id = row_of(*chord);
  } else {
    return false;  // no other limits are cuts
  }
  lp_.replace_row(row, draft_.columns, draft_.values, draft_.low, draft_.high);
  return true;
}

void LinearProgram::prepare(const Box& box, bool symmetric) {
  bool symmetry = false;
  std::vector<char> has_cone(box.corners.size(), 0);
  for (int row = lp_.rows() - 1; row >= base_rows_; --row) {
    if (carry_over(row, box, symmetric)) {
      const Id& id = ids_[static_cast<std::size_t>(row)];
      symmetry |= std::holds_alternative<Equation>(id);
      if (const auto* error = limit_of<proof::Error>(id)) has_cone[static_cast<std::size_t>(error->corner)] = 1;
    } else {
      lp_.remove_row(row);
      ids_[static_cast<std::size_t>(row)] = ids_.back();
      ids_.pop_back();
    }
  }
  lp_.set_column_bounds(excess(), -least_, DualSimplex::infinity);
  for (int i = 0; i <= largest_; ++i) lp_.set_column_bounds(i, 0.0, i <= box.order ? tap_bound(i) : 0.0);
  for (int k = 1; k <= largest_ + 1 && !model_.convex() && !window_; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const bool bounded = i < box.tube.low.size();
    lp_.set_row_bounds(tube_rows_ + k - 1, bounded ? box.tube.low[i] - slack : 0.0,
                       bounded ? box.tube.high[i] + slack : 1.0 + slack);
  }
  if (ranges_) prepare_ranges(box);
  for (std::size_t j = 0; j < box.corners.size(); ++j) {
    if (model_.cone(j) && has_cone[j] == 0 && !shared(j, box) && box.bounds_error(j))
      add_cone(j, box.only_angle.value_or(0.5 * model_.theta(j)), box);
  }
  if (symmetric && !symmetry) add_symmetry(box);
}

namespace {

/// Turns a row to its lower side. False: it has none.
bool turn_over(proof::Row& row) {
  if (auto* tap = std::get_if<proof::TapDifference>(&row))
    tap->sign = -1;
  else if (auto* response = std::get_if<proof::Response>(&row))
    response->sign = -1;
  else if (auto* vibration = std::get_if<proof::Vibration>(&row))
    vibration->angle += std::numbers::pi;
  else
    return false;
  return true;
}

}  // namespace

Multipliers LinearProgram::multipliers() const {
  Multipliers y;
  for (std::size_t r = 0; r < ids_.size(); ++r) {
    const auto* limit = std::get_if<proof::Row>(&ids_[r]);
    double value = -solution_.multipliers[r];  // > 0: the upper side
    if (limit == nullptr || std::abs(value) < 1e-13) continue;
    proof::Row row = *limit;
    if (value < 0.0) {
      value = -value;
      if (!turn_over(row)) continue;
    }
    if (const auto* difference = std::get_if<proof::TapDifference>(&row))
      value *= model_.rows.ramp_max(difference->limit);
    if (const auto* vibration = std::get_if<proof::Vibration>(&row)) value *= vibration_scale(*vibration);
    y.push_back({row, value});
  }
  return y;
}

}  // namespace accdec::exact
