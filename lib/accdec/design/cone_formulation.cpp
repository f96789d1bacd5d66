#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include <accdec/design/cone_formulation.hpp>
#include <accdec/exact/limit_model.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/task/convexity.hpp>

namespace accdec {
namespace {

class ConeBuilder {
 public:
  ConeBuilder(const Task& task, int order, const std::vector<CornerPlace>& at) : task_(task), model_(task) {
    box_.order = order;
    for (const CornerPlace& p : at) box_.corners.push_back({p.delay, p.delay, p.sample, p.sample});
    data_.c.assign(static_cast<std::size_t>(order) + 2, 0.0);
    data_.c.back() = 1.0;
  }

  nlp::ConeProblem build() && {
    for (int i = 0; i <= box_.order; ++i) data_.a.push_back({0, i, 1.0});
    data_.b = {1.0};
    taps();
    starts_and_stops();
    for (std::size_t j = 0; j < box_.corners.size(); ++j) blend(static_cast<int>(j));
    data_.linear = static_cast<int>(data_.h.size());
    for (std::size_t j = 0; j < box_.corners.size(); ++j)
      if (model_.cone(j)) error(j);
    for (const Mode& mode : task_.machine.modes) vibration(mode);
    return nlp::ConeProblem(std::move(data_));
  }

 private:
  int excess() const { return box_.order + 1; }
  int next() const { return static_cast<int>(data_.h.size()); }
  void add(int column, double value) {
    if (value != 0.0) data_.g.push_back({next(), column, value});
  }
  void end(double h) { data_.h.push_back(h); }

  void taps() {
    for (int i = 0; i <= box_.order; ++i) {
      add(i, -1.0), end(0.0);
      if (model_.rows.tap_max() < 1.0) add(i, 1.0 / model_.rows.tap_max()), end(1.0);
    }
  }
  void limit(const proof::Row& id) {
    const exact::SparseRow row = model_.row(id, box_);
    if (row.no_terms()) return;
    for (const auto& [i, c] : row.taps) add(i, c);
    for (const auto& [k, c] : row.sums)
      for (int i = 0; i < k; ++i) add(i, c);
    end(1.0 - row.constant);
  }
  void starts_and_stops() {
    for (const exact::RampLimit& ramp : model_.rows.ramps()) {
      for (int i = 0; i <= box_.order + ramp.differences; ++i)
        for (const int sign : {1, -1}) limit(proof::TapDifference{i, sign, ramp.kind});
    }
    for (const proof::Row& id : model_.rows.base_force_rows(box_.order)) limit(id);
  }
  void blend(int j) {
    for (int a = 0; a < static_cast<int>(task_.machine.axes.size()); ++a) {
      const exact::Legs v = exact::legs(task_.corners[static_cast<std::size_t>(j)], static_cast<std::size_t>(a));
      if (v.in == 0.0 || v.out == 0.0) continue;
      for (const AxisLimit& bound : axis_limits) {
        const bool convex = bound.differences >= 0 || bound.kind == LimitKind::force;
        if (!convex || task_.machine.axes[static_cast<std::size_t>(a)].*bound.bound >= unlimited) continue;
        const int last = box_.order + box_.corner(j).d1 + 1 + std::max(bound.differences, 0);
        for (int k = 1; k <= last; ++k)
          for (const int sign : {1, -1}) limit(proof::Blend{bound.kind, j, a, k, sign});
      }
    }
  }
  /// (error_max + e, p + q cos theta, q sin theta)
  void error(std::size_t j) {
    const double theta = model_.theta(j);
    add(excess(), -1.0), end(model_.error_bound(j));
    for (int i = 0; i <= box_.order; ++i) {
      add(i, model_.scale_in(j) * box_.weight_in(j, i) + model_.scale_out(j) * box_.weight_out(j, i) * std::cos(theta));
    }
    end(0.0);
    for (int i = 0; i <= box_.order; ++i) add(i, model_.scale_out(j) * box_.weight_out(j, i) * std::sin(theta));
    end(0.0);
    data_.cones.push_back(3);
  }
  /// (residual_max, sum b cos, sum b sin)
  void vibration(const Mode& mode) {
    const double width = mode.frequency_high - mode.frequency_low;
    const int cells = static_cast<int>(std::ceil(8.0 * width * task_.sample_period * (box_.order + 1)));
    for (int f = 0; f <= cells; ++f) {
      const double frequency = mode.frequency_low + (cells > 0 ? width * f / cells : 0.0);
      const double turn = 2.0 * std::numbers::pi * frequency * task_.sample_period;
      end(mode.residual_max);
      for (int i = 0; i <= box_.order; ++i) add(i, std::cos(turn * i));
      end(0.0);
      for (int i = 0; i <= box_.order; ++i) add(i, std::sin(turn * i));
      end(0.0);
      data_.cones.push_back(3);
    }
  }

  const Task& task_;
  exact::LimitModel model_;
  exact::Box box_;
  nlp::ConeData data_;
};

}  // namespace

nlp::ConeProblem cone_problem(const Task& task, int order, const std::vector<CornerPlace>& at) {
  require_no_response(task.machine, "a cone problem");
  require_no_shared_loads(task.machine, "a cone problem");
  if (!is_convex(task))
    throw std::invalid_argument("power, regeneration and smallest speeds are not convex: no cone program holds them");
  if (at.size() != task.corners.size()) throw std::invalid_argument("a place is needed for every corner, and no more");
  return ConeBuilder(task, order, at).build();
}

}  // namespace accdec
