#include <algorithm>
#include <memory>

#include <accdec/exact/linear_program.hpp>
#include <accdec/exact/relaxation.hpp>
#include <accdec/exact/window.hpp>

namespace accdec::exact {

class Relaxation::Impl {
 public:
  Impl(const LimitModel& model, int order, const std::function<bool()>& stop, double margin, BoxKind kind)
      : model_(model),
        stop_(stop),
        order_(order),
        kind_(kind),
        margin_(margin),
        program_(std::make_unique<LinearProgram>(model, order, stop, margin, kind)) {}

  Outcome solve(const Box& box, bool symmetric, bool strongest) {
    program_->prepare(box, symmetric);
    Outcome outcome = cut(box, symmetric, true, strongest);
    if (outcome.kind != Outcome::unresolved) return outcome;
    // Try again from a cold start, and then with Clp.
    for (const bool clp : {false, true}) {
      if (outcome.kind != Outcome::unresolved || (stop_ && stop_())) break;
      program_->start_cold();
      program_->prepare(box, symmetric);
      program_->use_clp_alone(clp);
      outcome = cut(box, symmetric, true, strongest);
    }
    program_->use_clp_alone(false);
    if (outcome.kind == Outcome::unresolved && margin_ == 0.0 && !(stop_ && stop_()))
      outcome = solve_almost_granted(box, symmetric, strongest);
    return outcome;
  }

  /// A limit outside the convex class holds if its tangent at a known point holds. The excess over these limits and the
  /// cones falls from point to point (convex-concave procedure).
  std::optional<Filter> repair(const Box& box, bool symmetric, Filter at) {
    std::vector<Chord> close;
    double before = DualSimplex::infinity;
    for (int round = 0; round < 30; ++round) {
      const double worst = model_.chords.gather_close(at, box, close);
      if (round > 0 && before <= 1e-10 && worst <= 1.0 + 3.0 * slack) return at;
      program_->prepare(box, symmetric);
      program_->soften(close, at, box);
      const Outcome outcome = cut(box, symmetric, false, false);
      if (!outcome.filter) return std::nullopt;
      if (outcome.excess > std::max(1e-10, 0.95 * before)) return std::nullopt;
      before = outcome.excess;
      at = *outcome.filter;
    }
    return std::nullopt;
  }

  /// As `repair`, but only the cones may be broken. Tangents imply their limits, so every step stays within the limits.
  std::optional<Filter> approach(const Box& box, bool symmetric, Filter at) {
    std::vector<Chord> close;
    model_.chords.gather_close(at, box, close);
    std::optional<Filter> best;
    double before = DualSimplex::infinity;
    for (int round = 0; round < 30; ++round) {
      program_->prepare(box, symmetric);
      program_->tie(close, at, box);
      const Outcome outcome = cut(box, symmetric, false, false);
      if (!outcome.filter) break;
      std::vector<Chord> reached = close;
      if (model_.chords.gather_close(*outcome.filter, box, reached) > 1.0 + 3.0 * slack) {
        if (reached.size() == close.size()) break;  // rounding
        close = std::move(reached);
        continue;
      }
      const bool little = outcome.excess > before - 1e-7 * (1.0 + before);
      at = *outcome.filter, best = at;
      before = outcome.excess;
      close = std::move(reached);
      if (little) break;
    }
    return best;
  }

  long linear_programs() const { return solved_; }

 private:
  Outcome solve_almost_granted(const Box& box, bool symmetric, bool strongest) {
    if (!wider_) wider_ = std::make_unique<LinearProgram>(model_, order_, stop_, almost_granted, kind_);
    std::swap(program_, wider_);
    program_->prepare(box, symmetric);
    Outcome outcome = cut(box, symmetric, true, strongest);
    std::swap(program_, wider_);
    return outcome;
  }

  /// @param refuting  stop as soon as the box is refuted (strongest: when no further cut improves that), else minimise
  /// the excess
  Outcome cut(const Box& box, bool symmetric, bool refuting, bool strongest) {
    Outcome outcome;
    double by = 0.0;
    const auto refuted = [&] {
      Multipliers y = program_->multipliers();
      const double value =
          box.window ? window_refutation(model_, y, box) : refutation(model_, y, box, symmetric ? box.order : -1);
      if (!(value > by)) return false;
      by = value;
      outcome.multipliers = std::move(y);
      outcome.kind = Outcome::refuted;
      return true;
    };
    for (int round = 0; round < 200; ++round) {
      ++solved_;
      const LpSolution& solution = program_->solve();
      if (solution.status == DualSimplex::Status::infeasible) {
        if (refuting) refuted();
        return outcome;
      }
      if (solution.status != DualSimplex::Status::optimal) return outcome;
      outcome.excess = solution.objective;
      if (refuting && outcome.excess > 0.0) {
        const double before = by;
        refuted();
        if (by > 0.0 && (!strongest || by <= 1.05 * before)) return outcome;
      }
      Filter filter = program_->filter(box, symmetric);
      if (!program_->cut(filter, box, refuting ? 0.0 : outcome.excess)) {
        if (by > 0.0) return outcome;
        outcome.filter = std::move(filter);
        for (std::size_t j = 0; j < box.corners.size() && program_->has_ranges(); ++j)
          outcome.delays.push_back(program_->delay(j)), outcome.samples.push_back(program_->sample(j));
        outcome.kind = Outcome::feasible;
        return outcome;
      }
    }
    return outcome;
  }

  const LimitModel& model_;
  std::function<bool()> stop_;
  int order_;
  BoxKind kind_;
  double margin_;
  std::unique_ptr<LinearProgram> program_, wider_;
  long solved_ = 0;
};

Relaxation::Relaxation(const LimitModel& model, int largest_order, const std::function<bool()>& stop, double margin,
                       BoxKind kind)
    : impl_(std::make_unique<Impl>(model, largest_order, stop, margin, kind)) {}
Relaxation::~Relaxation() = default;
Outcome Relaxation::solve(const Box& box, bool symmetric, bool strongest) {
  return impl_->solve(box, symmetric, strongest);
}
std::optional<Filter> Relaxation::repair(const Box& box, bool symmetric, const Filter& start) {
  return impl_->repair(box, symmetric, start);
}
std::optional<Filter> Relaxation::approach(const Box& box, bool symmetric, const Filter& start) {
  return impl_->approach(box, symmetric, start);
}
long Relaxation::linear_programs() const {
  return impl_->linear_programs();
}

}  // namespace accdec::exact
