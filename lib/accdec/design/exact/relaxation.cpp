#include <accdec/design/exact/relaxation.hpp>
#include <accdec/machine/utilisation.hpp>
#include <algorithm>
#include <cmath>
#include <coin/ClpSimplex.hpp>
#include <numbers>

namespace accdec::exact {
namespace {
/// Limits are met to within this in the programme, well inside the verifier's 1e-9, so that a limit used to its very
/// last bit does not fall between a solution that verifies and a refutation.
constexpr double slack = 3e-10;
constexpr std::size_t most_vibration_rows = 60;
}  // namespace

class Relaxation::Impl {
 public:
  Impl(const LimitModel& model, int order)
      : model_(model), largest_(order), columns_(order + 2 + (model.has_sums() ? order + 1 : 0)) {
    lp_.setLogLevel(0);
    lp_.messageHandler()->setLogLevel(0);
    lp_.setPrimalTolerance(1e-10);
    lp_.setDualTolerance(1e-9);
    lp_.scaling(0);
    lp_.resize(0, columns_);
    for (int i = 0; i < columns_; ++i) {
      lp_.setColumnBounds(i, 0.0, i <= order ? model.tap_max() * (1.0 + slack) : 1.0 + slack);
      lp_.setObjectiveCoefficient(i, 0.0);
    }
    lp_.setObjectiveCoefficient(excess(), 1.0);
    double least = 0.0;
    for (std::size_t j = 0; j < model.corners(); ++j) {
      if (model.cone(j)) least = std::max(least, model.error_bound(j));
    }
    lp_.setColumnBounds(excess(), -least, COIN_DBL_MAX);
    add_base_rows();
    base_rows_ = lp_.numberRows();
  }

  Outcome solve(const Box& box, bool symmetric) {
    prepare(box, symmetric);
    Outcome outcome;
    for (int round = 0; round < 200; ++round) {
      ++programmes_;
      lp_.dual();
      if (lp_.status() != 0 && lp_.status() != 1) lp_.primal();
      if (lp_.status() == 1) {
        const std::unique_ptr<double[]> ray(lp_.infeasibilityRay());
        if (!ray) return outcome;
        for (const double sign : {1.0, -1.0}) {
          outcome.multipliers = multipliers(ray.get(), sign);
          if (refutation(model_, outcome.multipliers, box, symmetric ? box.order : -1) > 0.0) {
            outcome.kind = Outcome::refuted;
            return outcome;
          }
        }
        return outcome;
      }
      if (lp_.status() != 0) return outcome;
      if (lp_.objectiveValue() > 0.0) {
        outcome.multipliers = multipliers(lp_.dualRowSolution(), 1.0);
        if (refutation(model_, outcome.multipliers, box, symmetric ? box.order : -1) > 0.0) {
          outcome.kind = Outcome::refuted;
          return outcome;
        }
      }
      const double* x = lp_.primalColumnSolution();
      std::vector<double> taps(static_cast<std::size_t>(box.order) + 1);
      for (std::size_t i = 0; i < taps.size(); ++i) taps[i] = std::max(0.0, x[i]);
      if (symmetric) {
        for (std::size_t i = 0; i < taps.size() / 2; ++i) {
          taps[i] = taps[taps.size() - 1 - i] = 0.5 * (taps[i] + taps[taps.size() - 1 - i]);
        }
      }
      const Filter filter(taps);
      bool added = cut_cones(filter, box);
      for (const RowId& id : model_.broken_blend_rows(filter, box, 2.0 * slack)) added |= add_sparse(id, box);
      added |= cut_vibration(filter, box);
      if (!added) {
        outcome.multipliers.clear();
        outcome.filter = filter;
        outcome.kind = Outcome::feasible;
        return outcome;
      }
    }
    return outcome;
  }

  long programmes() const { return programmes_; }

 private:
  int excess() const { return largest_ + 1; }
  int sum_column(int k) const { return largest_ + 1 + k; }  // B_k, k >= 1

  void add(const std::vector<int>& columns, const std::vector<double>& values, double low, double high,
           const RowId& id) {
    lp_.addRow(static_cast<int>(columns.size()), columns.data(), values.data(), low, high);
    ids_.push_back(id);
  }

  void add_base_rows() {
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

  void add_row(const RowId& id, const SparseRow& row, bool both) {
    std::vector<int> columns;
    std::vector<double> values;
    const auto entry = [&](int column, double value) {
      for (std::size_t i = 0; i < columns.size(); ++i) {
        if (columns[i] == column) {
          values[i] += value;
          return;
        }
      }
      columns.push_back(column);
      values.push_back(value);
    };
    // Jerk in units of a tap, others of their bound: entries of the order of 1.
    const double scale = id.kind == RowKind::jerk ? model_.jerk_max() : 1.0;
    for (const auto& [i, c] : row.taps) entry(i, c * scale);
    for (const auto& [k, c] : row.sums) entry(sum_column(k), c * scale);
    const double bound = (1.0 + slack) * scale;
    add(columns, values, both ? -bound : -COIN_DBL_MAX, bound - row.constant * scale, id);
  }

  bool add_sparse(const RowId& id, const Box& box) {
    for (std::size_t r = static_cast<std::size_t>(base_rows_); r < ids_.size(); ++r) {
      const RowId& old = ids_[r];
      if (old.kind == id.kind && old.corner == id.corner && old.axis == id.axis && old.sample == id.sample &&
          old.sign == id.sign)
        return false;
    }
    add_row(id, model_.row(id, box), false);
    return true;
  }

  void add_cone(std::size_t j, double angle, const Box& box) {
    const CornerBox& b = box.corners[j];
    const double wp = model_.weight_in(j, angle), wq = model_.weight_out(j, angle);
    std::vector<int> columns{excess()};
    std::vector<double> values{-1.0};
    for (int i = 0; i <= largest_; ++i) {
      const double c = wp * std::max(0, i - b.k2) + wq * std::max(0, b.k1 - b.d2 - i);
      if (c != 0.0) columns.push_back(i), values.push_back(c);
    }
    RowId id;
    id.kind = RowKind::cone;
    id.corner = static_cast<int>(j);
    id.angle = angle;
    add(columns, values, -COIN_DBL_MAX, model_.error_bound(j) * (1.0 + slack), id);
  }

  static bool loose(const CornerBox& b) { return b.k1 < b.k2 || b.d1 < b.d2; }

  bool cut_cones(const Filter& filter, const Box& box) {
    bool added = false;
    for (std::size_t j = 0; j < box.corners.size(); ++j) {
      if (!model_.cone(j)) continue;
      const CornerBox& b = box.corners[j];
      const double p = model_.scale_in(j) * filter.remaining_moment(b.k2),
                   q = model_.scale_out(j) * filter.elapsed_moment(b.k1 - b.d2);
      const double theta = model_.theta(j);
      double angle = std::atan2(q * std::sin(theta), p + q * std::cos(theta));
      // Within a box only cuts that grow with both distances hold.
      if (loose(b)) angle = std::clamp(angle, theta - 0.5 * std::numbers::pi, 0.5 * std::numbers::pi);
      const double value = p * std::cos(angle) + q * std::cos(theta - angle);
      if (value <= model_.error_bound(j) * (1.0 + 2.0 * slack) + 1e-13) continue;
      for (std::size_t r = static_cast<std::size_t>(base_rows_); r < ids_.size(); ++r) {
        if (ids_[r].kind == RowKind::cone && ids_[r].corner == static_cast<int>(j) &&
            std::abs(ids_[r].angle - angle) < 1e-11)
          angle = 10.0;
      }
      if (angle > 9.0) continue;  // the programme's own tolerance
      add_cone(j, angle, box);
      added = true;
    }
    return added;
  }

  bool cut_vibration(const Filter& filter, const Box& box) {
    bool added = false;
    const double t = model_.task().sample_period;
    const auto uses = vibration_utilisation(filter, t, model_.task().machine);
    for (std::size_t m = 0; m < uses.size(); ++m) {
      if (uses[m].value <= uses[m].bound * (1.0 + 2.0 * slack) + 1e-13) continue;
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
        if (old.mode == id.mode && old.frequency == id.frequency && std::abs(old.angle - id.angle) < 1e-11)
          id.mode = -1;
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

  void add_vibration(const RowId& id) {
    std::vector<int> columns;
    std::vector<double> values;
    for (int i = 0; i <= largest_; ++i) columns.push_back(i), values.push_back(model_.vibration_coefficient(id, i));
    const double bound = model_.task().machine.modes[static_cast<std::size_t>(id.mode)].residual_max * (1.0 + slack);
    add(columns, values, -bound, bound, id);
  }

  /// Rows of the last box go; its cuts come again at their angles in the new box.
  void prepare(const Box& box, bool symmetric) {
    std::vector<std::pair<std::size_t, double>> angles;
    std::vector<int> old;
    for (int r = base_rows_; r < lp_.numberRows(); ++r) {
      const RowId& id = ids_[static_cast<std::size_t>(r)];
      if (id.kind == RowKind::cone && id.corner >= 0 && lp_.getRowStatus(r) != ClpSimplex::basic) {
        angles.emplace_back(static_cast<std::size_t>(id.corner), id.angle);
      }
      old.push_back(r);
    }
    if (!old.empty()) lp_.deleteRows(static_cast<int>(old.size()), old.data());
    ids_.resize(static_cast<std::size_t>(base_rows_));
    for (int i = 0; i <= largest_; ++i) lp_.setColumnUpper(i, i <= box.order ? model_.tap_max() * (1.0 + slack) : 0.0);
    for (const auto& [j, angle] : angles) {
      const bool grows = std::cos(angle) >= 0.0 && std::cos(model_.theta(j) - angle) >= 0.0;
      if (grows || !loose(box.corners[j])) add_cone(j, angle, box);
    }
    for (std::size_t j = 0; j < box.corners.size(); ++j) {
      const bool kept = std::any_of(angles.begin(), angles.end(), [&](const auto& a) { return a.first == j; });
      if (model_.cone(j) && !kept) add_cone(j, 0.5 * model_.theta(j), box);
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

  Multipliers multipliers(const double* dual, double sign) const {
    Multipliers y;
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
      y.emplace_back(id, value);
    }
    return y;
  }

  const LimitModel& model_;
  int largest_, columns_, base_rows_ = 0;
  ClpSimplex lp_;
  std::vector<RowId> ids_;
  std::vector<RowId> vibration_;
  long programmes_ = 0;
};

Relaxation::Relaxation(const LimitModel& model, int largest_order)
    : impl_(std::make_unique<Impl>(model, largest_order)) {}
Relaxation::~Relaxation() = default;
Outcome Relaxation::solve(const Box& box, bool symmetric) {
  return impl_->solve(box, symmetric);
}
long Relaxation::programmes() const {
  return impl_->programmes();
}

}  // namespace accdec::exact
