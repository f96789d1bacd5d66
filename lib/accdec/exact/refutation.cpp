#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <accdec/exact/limit_model.hpp>
#include <accdec/exact/one_width.hpp>
#include <accdec/exact/range_cut.hpp>
#include <accdec/exact/reversal.hpp>
#include <accdec/machine/limits.hpp>

namespace accdec::exact {
namespace {

/// The sum y (form - bound): coefficients of taps, cumulative responses, delays and samples.
class WeightedSum {
 public:
  WeightedSum(const LimitModel& model, const Box& box, int order)
      : model_(model),
        box_(box),
        exact_box_(order == box.order ? box : other_order_.emplace(box)),
        sum_(model.rows.smoothing(), order) {
    if (other_order_) other_order_->order = order;
    if (!box.budget) return;
    delays_.assign(box.corners.size(), 0.0);
    samples_.assign(box.corners.size(), 0.0);
  }

  /// False: the row does not apply to the box.
  bool add(const proof::Term& term) {
    return std::visit([&](const auto& row) { return add(row, term.multiplier); }, term.row);
  }

  /// The minimum over all filters, delays and samples, less the largest rounding.
  double least(bool symmetric) {
    std::vector<double>& taps = sum_.all();
    const std::size_t size = taps.size();
    for (std::size_t i = 0; symmetric && i < size / 2; ++i)
      taps[i] = taps[size - 1 - i] = 0.5 * (taps[i] + taps[size - 1 - i]);
    double least = cheapest_filter(taps);
    if (least == infinity) return infinity;
    for (std::size_t j = 0; j < delays_.size(); ++j) {
      const CornerBox& b = box_.corners[j];
      least += std::min(0.0, delays_[j]) * (b.d2 - b.d1) + std::min(0.0, samples_[j]) * (b.k2 - b.k1);
    }
    return least - rhs_ - (box_.budget ? 1e-11 : 1e-13) * (magnitude_ + std::abs(rhs_));
  }

 private:
  /// Least sum c_i b_i: fill the cheapest taps.
  double cheapest_filter(std::vector<double>& c) const {
    const double u = model_.rows.tap_max();
    if (static_cast<double>(c.size()) * u < 1.0 - 1e-12) return infinity;
    const auto full = std::min(c.size() - 1, static_cast<std::size_t>(1.0 / u));
    std::nth_element(c.begin(), c.begin() + static_cast<std::ptrdiff_t>(full), c.end());
    double least = 0.0;
    for (std::size_t i = 0; i < full; ++i) least += u * c[i];
    return least + (1.0 - u * static_cast<double>(full)) * c[full];
  }

  bool counts(double y, double rhs) {
    rhs_ += rhs;
    magnitude_ += y;
    return true;
  }

  bool add(const proof::Error& id, double y) {
    const auto j = static_cast<std::size_t>(id.corner);
    const double wp = y * model_.weight_in(j, id.angle), wq = y * model_.weight_out(j, id.angle);
    if (box_.loose(j) && (wp < -1e-16 || wq < -1e-16)) return false;
    add_distances(j, wp, wq);
    return counts(y, y * model_.error_bound(j));
  }

  void add_distances(std::size_t j, double wp, double wq) {
    if (!box_.distances.empty() || box_.servo != nullptr) {
      for (int i = 0; i <= exact_box_.order; ++i)
        sum_.designed()[static_cast<std::size_t>(i)] += wp * box_.weight_in(j, i) + wq * box_.weight_out(j, i);
      return;
    }
    const int in = box_.corners[j].k2, out = box_.first_out(j), order = exact_box_.order;
    for (int i = std::max(0, in + 1); i <= order; ++i) sum_.designed()[static_cast<std::size_t>(i)] += wp * (i - in);
    for (int i = 0; i < std::min(out, order + 1); ++i) sum_.designed()[static_cast<std::size_t>(i)] += wq * (out - i);
  }

  bool add(const proof::RangeError& id, double y) {
    const auto j = static_cast<std::size_t>(id.corner);
    const double wp = y * model_.weight_in(j, id.angle), wq = y * model_.weight_out(j, id.angle);
    if (!box_.budget || wp < 0.0 || wq < 0.0) return false;
    const RangeRow row = range_row(exact_box_, j, id.in, id.out, wp, wq);
    for (std::size_t i = 0; i < row.taps.size(); ++i) sum_.designed()[i] += row.taps[i];
    delays_[j] += row.on_delay;
    samples_[j] += row.on_sample;
    return counts(y, y * model_.error_bound(j) - row.constant);
  }

  bool add(const proof::Contour& id, double y) {
    const auto j = static_cast<std::size_t>(id.corner);
    if (!box_.contour_rows() || !model_.contour(j)) return false;
    for (int i = 0; i <= exact_box_.order; ++i)
      sum_.designed()[static_cast<std::size_t>(i)] +=
          y * (id.out ? model_.scale_out(j) * box_.contour_out(j, i) : model_.scale_in(j) * box_.contour_in(j, i));
    return counts(y, y * model_.contour_bound(j));
  }

  bool add(const proof::Width& id, double y) {
    const auto row = width_row(model_.task(), id, exact_box_);
    if (!row) return false;
    const std::span<double> taps = row->actual ? sum_.designed() : sum_.command();
    for (std::size_t i = 0; i < taps.size(); ++i) taps[i] += y * row->weight(exact_box_, static_cast<int>(i));
    return counts(y, y * width_granted);
  }

  bool add(const proof::Budget&, double y) {
    if (!box_.budget) return false;
    for (std::size_t j = 0; j < box_.corners.size(); ++j) delays_[j] += y * model_.task().corners[j].weight;
    return counts(y, y * *box_.budget);
  }

  bool add(const proof::Vibration& id, double y) {
    const double bound = model_.rows.vibration_bound(id, exact_box_);
    if (bound == infinity) return false;
    model_.rows.add_vibration(id, y, sum_.command());
    return counts(y, y * bound);
  }

  template <class Limit>
  requires std::is_same_v<Limit, proof::TapDifference> || std::is_same_v<Limit, proof::EventForce>
  bool add(const Limit& id, double y) { return add(model_.rows.row(id, exact_box_), y); }
  template <class Limit>
  requires std::is_same_v<Limit, proof::Blend> || std::is_same_v<Limit, proof::Reversal>
  bool add(const Limit& id, double y) {
    if (!known_in(id, box_)) return false;
    // An axis slower than this part of its feed may count as standing.
    if constexpr (std::is_same_v<Limit, proof::Reversal>) rhs_ += id.sign < 0 ? y * 2.0 * still_part : 0.0;
    return add(model_.rows.row(id, exact_box_), y);
  }
  bool add(const proof::Response& id, double y) {
    if (id.sample > exact_box_.order + model_.rows.motion().order()) return true;
    return has_tube() && add(model_.row(id, exact_box_), y);
  }
  /// Power and smallest speed.
  template <class NotConvex>
  bool add(const NotConvex& id, double y) {
    return add(*chord_of(id), y);
  }

  bool add(const Chord& chord, double y) {
    if (!model_.chords.single_delay(chord.family, box_)) return false;
    // This chord is of a longer filter or delay: here the speed is already constant.
    if (chord.sample > model_.chords.last_sample(chord.family, exact_box_)) return true;
    if (!has_tube() || !model_.chords.covers(chord, exact_box_)) return false;
    return add(model_.chords.row(chord, exact_box_), y);
  }

  bool has_tube() const {
    return static_cast<int>(exact_box_.tube.low.size()) == exact_box_.order + model_.rows.motion().order() + 2;
  }

  bool add(const SparseRow& row, double y) {
    if (row.no_terms() && row.constant <= 1.0) return true;
    model_.rows.add(row, y, false, sum_);
    return counts(y, y * (1.0 - row.constant));
  }

  const LimitModel& model_;
  const Box& box_;
  std::optional<Box> other_order_;
  const Box& exact_box_;  // of the order asked for
  WeightedTaps sum_;
  std::vector<double> delays_, samples_;
  double rhs_ = 0.0, magnitude_ = 0.0;
};

}  // namespace

double refutation(const LimitModel& model, const Multipliers& y, const Box& box, int symmetric_order) {
  WeightedSum sum(model.granted(), box, symmetric_order >= 0 ? symmetric_order : box.order);
  for (const proof::Term& term : y) {
    if (!sum.add(term)) return -infinity;
  }
  return sum.least(symmetric_order >= 0);
}

}  // namespace accdec::exact
