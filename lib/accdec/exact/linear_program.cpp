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
      drafts_(model, order, slack_, kind == BoxKind::window),
      stop_(stop),
      kind_{.window = kind == BoxKind::window, .ranges = kind == BoxKind::budget && model.corners() > 1},
      lp_(order + 2 + (kind_.ranges ? 2 * static_cast<int>(model.corners()) : 0)) {
  lp_.set_stop(stop);
  for (int i = 0; i <= order; ++i) lp_.set_column_bounds(i, 0.0, tap_bound(i));
  lp_.set_cost(drafts_.excess(), 1.0);
  for (std::size_t j = 0; j < model.corners(); ++j) {
    if (model.cone(j)) least_ = std::max(least_, model.error_bound(j));
    if (model.contour(j)) least_ = std::max(least_, model.contour_bound(j));
  }
  add_base_rows();
  names_.end_base();
}

/// The end columns of a window stand for many taps.
double LinearProgram::tap_bound(int column) const {
  return kind_.window && (column == 0 || column == largest_) ? 1.0 : model_.rows.tap_max() * (1.0 + slack_);
}

const LpSolution& LinearProgram::solve() {
  if (kind_.clp_alone) return solution_ = solve_by_clp(lp_.given(), stop_);
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
  while (lp_.rows() > names_.base()) lp_.remove_row(lp_.rows() - 1);
  names_.remove_cuts();
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
  lp_.set_column_bounds(drafts_.excess(), 0.0, DualSimplex::infinity);
  std::optional<Filter> made;
  const Filter& motion = model_.rows.motion().behind(at, made);
  for (const Chord& chord : close) {
    const auto tangent = model_.chords.tangent(chord, motion, box, least_use);
    if (!tangent) continue;
    add(drafts_.limit(model_.chords.row(*tangent, box), 1.0, false, soft), row_of(*tangent));
  }
}

void LinearProgram::add(const DraftRow& row, RowName name) {
  lp_.add_row(row.columns, row.values, row.low, row.high);
  names_.add(std::move(name));
}

void LinearProgram::add_base_rows() {
  add(drafts_.sum_of_taps(), Equation{});
  Box all;
  all.order = largest_;
  all.corners.resize(model_.corners());
  all.window = kind_.window;
  // Rows of differences are in units of a tap, others in units of their bound, so that entries are of the order of 1.
  for (const RampLimit& ramp : model_.rows.ramps()) {
    const double reach = std::ldexp(1.0, std::max(0, ramp.differences - 1));  // of any taps from 0 to 1
    for (int i = 0; ramp.max < reach && i <= largest_ + model_.rows.smoothing().order() + ramp.differences; ++i) {
      const proof::TapDifference id{i, 1, ramp.kind};
      if (kind_.window && !inside_window(id, all, model_.rows)) continue;
      add(drafts_.limit(model_.rows.row(id, all), ramp.max, true), id);
    }
  }
  for (const proof::Row& id : model_.rows.base_force_rows(largest_)) {
    if (kind_.window && !inside_window(id, all, model_.rows)) continue;
    add(drafts_.limit(model_.row(id, all), 1.0, false), id);
  }
  tube_rows_ = lp_.rows();
  if (model_.convex() || kind_.window) return;
  for (int k = 1; k <= largest_ + model_.rows.motion().order() + 1; ++k)
    add(drafts_.response(k), proof::Response{k, 1});
}

void LinearProgram::add_cone(std::size_t j, double angle, const Box& box) {
  const proof::Error id{static_cast<int>(j), angle};
  add(drafts_.cone(id, box), id);
}

/// Those that the program does not have yet.
void LinearProgram::add_contours(std::size_t j, const Box& box) {
  if (!model_.contour(j)) return;
  for (const bool out : {false, true}) {
    const proof::Contour id{static_cast<int>(j), out};
    if (names_.known(id)) continue;
    if (const DraftRow* row = drafts_.contour(id, box)) add(*row, id);
  }
}

/// Gives a cut its coefficients in a new box. False: it is not worth keeping, or says nothing there.
bool LinearProgram::carry_over(int row, const Box& box, bool symmetric) {
  RowName& name = names_[row];
  const bool active = lp_.active(row);
  if (const auto* equation = std::get_if<Equation>(&name)) return symmetric && equation->order == box.order;
  const DraftRow* draft = nullptr;
  if (const auto* vibration = limit_of<proof::Vibration>(name)) {
    if (!active && lp_.rows() - names_.base() > most_vibration_rows) return false;
    if (vibration->damping == 0.0 && vibration->corner < 0) return true;
    draft = drafts_.again(*vibration, box);
  } else if (limit_of<proof::Budget>(name) != nullptr) {
    if (box.budget) draft = &drafts_.budget(box);
  } else if (const auto* contour = limit_of<proof::Contour>(name)) {
    draft = drafts_.contour(*contour, box);
  } else if (const auto* width = limit_of<proof::Width>(name)) {
    draft = drafts_.width(*width, box);
  } else if (!active) {
    return false;
  } else if (limit_of<proof::EventForce>(name) != nullptr) {
    return true;  // of a longer filter whose last taps are zero
  } else if (const auto* error = limit_of<proof::Error>(name)) {
    draft = drafts_.again(*error, box);
  } else if (const auto* range = limit_of<proof::RangeError>(name)) {
    draft = drafts_.again(*range, box);
  } else if (const auto* blend = limit_of<proof::Blend>(name)) {
    draft = drafts_.again(*blend, box);
  } else if (const auto* reversal = limit_of<proof::Reversal>(name)) {
    draft = drafts_.again(*reversal, box);
  } else if (auto chord = chord_of(std::get<proof::Row>(name))) {
    draft = drafts_.again(*chord, box);
    if (draft != nullptr) name = row_of(*chord);
  }  // no other limits are cuts
  if (draft == nullptr) return false;
  lp_.replace_row(row, draft->columns, draft->values, draft->low, draft->high);
  return true;
}

void LinearProgram::prepare(const Box& box, bool symmetric) {
  bool symmetry = false;
  std::vector<char> has_cone(box.corners.size(), 0);
  for (int row = lp_.rows() - 1; row >= names_.base(); --row) {
    if (carry_over(row, box, symmetric)) {
      symmetry |= std::holds_alternative<Equation>(names_[row]);
      if (const auto* error = limit_of<proof::Error>(names_[row]))
        has_cone[static_cast<std::size_t>(error->corner)] = 1;
    } else {
      lp_.remove_row(row);
      names_.remove(row);
    }
  }
  lp_.set_column_bounds(drafts_.excess(), -least_, DualSimplex::infinity);
  for (int i = 0; i <= largest_; ++i) lp_.set_column_bounds(i, 0.0, i <= box.order ? tap_bound(i) : 0.0);
  const int responses = model_.convex() || kind_.window ? 0 : largest_ + model_.rows.motion().order() + 1;
  for (int k = 1; k <= responses; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const bool bounded = i < box.tube.low.size();
    lp_.set_row_bounds(tube_rows_ + k - 1, bounded ? box.tube.low[i] - slack : 0.0,
                       bounded ? box.tube.high[i] + slack : 1.0 + slack);
  }
  if (kind_.ranges) prepare_ranges(box);
  for (std::size_t j = 0; j < box.corners.size(); ++j) {
    if (model_.cone(j) && has_cone[j] == 0 && !RowDrafts::shared(j, box) && box.bounds_error(j))
      add_cone(j, box.only_angle.value_or(0.5 * model_.theta(j)), box);
    add_contours(j, box);
  }
  for (int i = 0; symmetric && !symmetry && 2 * i < box.order; ++i)
    add(drafts_.equal_taps(i, box.order - i), Equation{box.order});
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
  for (int r = 0; r < names_.rows(); ++r) {
    const auto* limit = std::get_if<proof::Row>(&names_[r]);
    double value = -solution_.multipliers[static_cast<std::size_t>(r)];  // > 0: the upper side
    if (limit == nullptr || std::abs(value) < 1e-13) continue;
    proof::Row row = *limit;
    if (value < 0.0) {
      value = -value;
      if (!turn_over(row)) continue;
    }
    if (const auto* difference = std::get_if<proof::TapDifference>(&row))
      value *= model_.rows.ramp_max(difference->limit);
    if (const auto* vibration = std::get_if<proof::Vibration>(&row)) value *= drafts_.vibration_scale(*vibration);
    y.push_back({row, value});
  }
  return y;
}

}  // namespace accdec::exact
