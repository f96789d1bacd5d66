#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <numbers>
#include <utility>

#include <accdec/design/fitted_families.hpp>
#include <accdec/families/poles.hpp>

namespace accdec {
namespace {

/// Members of a family that are fitted again with commands a few samples earlier or later.
constexpr std::size_t most_averages = 300, most_others = 60;
/// With fewer taps, a family with a real number fits nearly any filter.
constexpr int least_order = 7;
/// A finite exponential has more than this part of its first tap left at its end; others are poles.
constexpr double finite_rest = 1e-3;

/// A family with an order and a real number, as a part of its range.
struct OfTwoNumbers {
  SettingFamily family;
  FilterSpec (*member)(int order, double part);
};
constexpr std::array<OfTwoNumbers, 3> of_two_numbers{
    {{SettingFamily::exponential,
      [](int order, double part) {
        return FilterSpec{
            .kind = Shape::exponential, .order = order, .ratio = std::exp(part * std::log(finite_rest) / (order + 1))};
      }},
     {SettingFamily::gaussian,
      [](int order, double part) { return FilterSpec{.kind = Shape::gaussian, .order = order, .alpha = 6.0 * part}; }},
     {SettingFamily::windowed_sinc, [](int order, double part) {
        return FilterSpec{.kind = Shape::blackman_sinc, .order = order, .cutoff = 2.0 * part / order};
      }}}};

double variance_of(const std::vector<int>& lengths) {
  double sum = 0.0;
  for (const int length : lengths) sum += (length * static_cast<double>(length) - 1.0) / 12.0;
  return sum;
}

/// The variance of the impulses.
double variance_of(const ShaperInfo& shaper, double delay) {
  return delay * delay * (shaper.pairs == 1 ? 0.25 : 2.0 * shaper.outer);
}

double variance_of(const Filter& filter) {
  double sum = 0.0;
  for (int i = 0; i <= filter.order(); ++i) sum += std::pow(i - filter.mean_delay(), 2) * filter.tap(i);
  return sum;
}

double variance_of(const FilterSpec& spec) {
  const ShaperInfo* shaper = shaper_of(spec);
  return variance_of(spec.lengths) + (shaper == nullptr ? 0.0 : variance_of(*shaper, spec.pair_delay));
}

/// The least of a function by golden section.
double golden_least(const std::function<double(double)>& squares, double low, double high, int steps = 30) {
  const double golden = 0.5 * (std::sqrt(5.0) - 1.0);
  double left = high - golden * (high - low), right = low + golden * (high - low);
  double at_left = squares(left), at_right = squares(right);
  for (int i = 0;; ++i) {
    const bool lower = at_left < at_right;
    (lower ? high : low) = lower ? right : left;
    if (i + 1 == steps) return 0.5 * (low + high);
    // One of the two points of the smaller range is known.
    if (lower) {
      right = left, at_right = at_left;
      at_left = squares(left = high - golden * (high - low));
    } else {
      left = right, at_left = at_right;
      at_right = squares(right = low + golden * (high - low));
    }
  }
}

class FamilyFits {
 public:
  FamilyFits(const FitWindow& window, int order_max, int pole_order_max, double period, Ends ends)
      : window_(window),
        order_max_(order_max),
        pole_order_max_(pole_order_max),
        period_(period),
        reading_{.ends = ends, .samples = 0} {}

  std::vector<FamilyFit> run(bool whole) {
    averages();
    if (whole) {
      const double variance = variance_of(best().fitted.filter);
      keep(most_averages);
      pole();
      two_poles();
      for (const OfTwoNumbers& family : of_two_numbers) scan(family, variance);
      shapers(variance);
      keep(most_others);
    } else {
      const double variance = variance_of(best().fitted.filter);
      tried_.clear();
      shapers(variance);
      between_samples();
    }
    sort(kept_);
    return std::move(kept_);
  }

 private:
  static void sort(std::vector<FamilyFit>& fits) {
    std::stable_sort(fits.begin(), fits.end(),
                     [](const FamilyFit& a, const FamilyFit& b) { return a.squares < b.squares; });
  }
  const FamilyFit& best() const {
    return *std::min_element(tried_.begin(), tried_.end(),
                             [](const FamilyFit& a, const FamilyFit& b) { return a.squares < b.squares; });
  }
  double squares_of(const FilterSpec& spec, int around) const {
    return window_.fit(make_filter(spec), around, reading_).squares;
  }

  void offer(SettingFamily family, const FilterSpec& spec, int parameters, int around = 0) {
    FamilyFit fit;
    fit.fitted.family = family;
    fit.fitted.filter = spec;
    fit.fitted.parameters = parameters;
    fit.reading = reading_;
    fit.squares = squares_of(spec, around);
    tried_.push_back(std::move(fit));
  }

  /// The best of those tried are fitted with commands that begin and end a sample earlier or later, too.
  void keep(std::size_t most) {
    sort(tried_);
    tried_.resize(std::min(tried_.size(), most));
    for (FamilyFit& fit : tried_) fit.squares = squares_of(fit.fitted.filter, 2);
    std::move(tried_.begin(), tried_.end(), std::back_inserter(kept_));
    tried_.clear();
  }

  static FilterSpec cascade(std::vector<int> lengths) {
    FilterSpec spec{.kind = Shape::averages, .lengths = std::move(lengths)};
    for (const int length : spec.lengths) spec.order += length - 1;
    return spec;
  }

  /// One and two averages of every length; an average of one tap is none. A third only where two of nearly this kind
  /// fit: there are a hundred times as many.
  void averages() {
    for (int a = 1; a - 1 <= order_max_; ++a) {
      offer(SettingFamily::averages, cascade({a}), a == 1 ? 0 : 1);
      for (int b = 2; b <= a && a + b - 2 <= order_max_; ++b) offer(SettingFamily::averages, cascade({a, b}), 2);
    }
    const double variance = variance_of(best().fitted.filter);
    for (int a = 2; a <= order_max_; ++a) {
      for (int b = 2; b <= a; ++b) {
        for (int c = 2; c <= b && a + b + c - 3 <= order_max_; ++c) {
          if (std::abs(variance_of({a, b, c}) - variance) > 0.02 * variance + 2.0) continue;
          offer(SettingFamily::averages, cascade({a, b, c}), 3);
        }
      }
    }
  }

  /// By time constants a part in a hundred apart, then golden section.
  void pole() {
    const auto squares = [&](double constant) { return squares_of(cut_pole(constant), 1); };
    double near = 0.5, least = std::numeric_limits<double>::infinity();
    constexpr double step = 1.02;
    for (double constant = 0.3; cut_pole(constant).order <= pole_order_max_; constant *= step) {
      if (const double found = squares(constant); found < least) least = found, near = constant;
    }
    const double constant = golden_least(squares, near / step, near * step);
    offer(SettingFamily::one_pole, cut_pole(constant), 1);
    tried_.back().fitted.time_constant = constant * period_;
    keep(1);
  }

  /// Two poles in series: the root of the sum of their squares, which the log shows best, and the angle of their ratio.
  void two_poles() {
    const auto filter = [](double size, double angle) {
      return cut_poles({size * std::cos(angle), size * std::sin(angle)});
    };
    const auto squares = [&](double size, double angle) { return squares_of(filter(size, angle), 1); };
    constexpr double equal = 0.25 * std::numbers::pi, least_angle = 0.05, step = 1.05, wide = 1.1;
    constexpr int steps = 14;
    double size = 1.0, angle = equal, least = std::numeric_limits<double>::infinity();
    for (double at = 0.5; filter(at, equal).order <= pole_order_max_; at *= step) {
      for (const double part : {1.0, 0.6, 0.25}) {
        if (const double found = squares(at, part * equal); found < least)
          least = found, size = at, angle = part * equal;
      }
    }
    const auto best_size = [&](double of_angle) {
      return golden_least([&](double at) { return squares(at, of_angle); }, size / wide, size * wide, steps);
    };
    const double narrow = std::max(least_angle, angle - 0.4 * equal), open = std::min(equal, angle + 0.4 * equal);
    angle = golden_least([&](double at) { return squares(best_size(at), at); }, narrow, open, steps);
    size = best_size(angle);
    offer(SettingFamily::one_pole, filter(size, angle), 2);
    tried_.back().fitted.time_constant = size * std::cos(angle) * period_;
    tried_.back().fitted.second_constant = size * std::sin(angle) * period_;
    keep(1);
  }

  /// Coarse steps of the number for every order, then golden section around the best. The steps are fine: commands
  /// begin on a sample, so that every mean delay with a whole number of samples to it is a minimum of its own.
  /// @param variance  about that of the filter
  void scan(const OfTwoNumbers& family, double variance) {
    constexpr int steps = 64;
    constexpr std::size_t most_minima = 40;
    struct Found {
      int order, step;
      double squares;
    };
    std::vector<Found> found;
    const auto part_of = [](int step) { return (step + 0.5) / steps; };
    for (int order = least_order; order <= order_max_; ++order) {
      for (int step = 0; step < steps; ++step) {
        const Filter filter = make_filter(family.member(order, part_of(step)));
        if (std::abs(variance_of(filter) - variance) > 0.3 * variance + 4.0) continue;
        found.push_back({order, step, window_.fit(filter, 0, reading_).squares});
      }
    }
    std::stable_sort(found.begin(), found.end(), [](const Found& a, const Found& b) { return a.squares < b.squares; });
    found.resize(std::min(found.size(), most_minima));
    for (const Found& at : found) {
      const double part = golden_least([&](double p) { return squares_of(family.member(at.order, p), 0); },
                                       std::max(1e-3, part_of(at.step - 1)), std::min(1.0, part_of(at.step + 1)));
      const FilterSpec spec = family.member(at.order, part);
      offer(family.family, spec, 2);
      if (spec.kind == Shape::exponential) tried_.back().fitted.time_constant = -period_ / std::log(spec.ratio);
    }
    keep(most_others);
  }

  /// One average and then two, with the impulses of every shaper at whole samples, of about the variance of the best.
  void shapers(double variance) {
    const auto within = [&](double part, double more, double variance_now) {
      return std::pair{variance_now * (1.0 - part) - more, variance_now * (1.0 + part) + more};
    };
    for (const bool two : {false, true}) {
      const auto [low, high] = two ? within(0.02, 2.0, variance) : within(0.1, 4.0, variance);
      for (const ShaperInfo& shaper : shaper_list()) {
        for (int delay = 1; shaper.pairs * delay <= order_max_; ++delay) {
          const double impulses = variance_of(shaper, delay);
          const int left = order_max_ - shaper.pairs * delay;
          const auto average = [&](std::vector<int> lengths) {
            FilterSpec spec = cascade(std::move(lengths));
            spec.pairs = shaper.pairs, spec.outer = shaper.outer, spec.pair_delay = delay;
            // Which shaper it is counts as a number, too.
            offer(SettingFamily::shaper, spec, two ? 4 : spec.order == 0 ? 2 : 3);
          };
          if (spec_order_too_short(shaper.pairs * delay)) continue;
          for (int a = two ? 2 : 1; a - 1 <= left; ++a) {
            const double so_far = impulses + variance_of(std::vector{a});
            if (!two && so_far >= low && so_far <= high) average({a});
            if (!two) continue;
            const auto length_of = [&](double rest) { return std::sqrt(std::max(0.0, 12.0 * (rest - so_far) + 1.0)); };
            for (int b = std::max(2, static_cast<int>(std::ceil(length_of(low))));
                 b <= std::min({a, left + 2 - a, static_cast<int>(length_of(high))}); ++b)
              average({a, b});
          }
        }
      }
      if (!two && !tried_.empty()) variance = variance_of(best().fitted.filter);
    }
  }
  /// With few taps other families say the same.
  static bool spec_order_too_short(int order) { return order < 2; }

  /// Impulses between samples, around the best whole ones.
  void between_samples() {
    sort(tried_);
    tried_.resize(std::min(tried_.size(), most_others));
    const std::vector<FamilyFit> whole = std::exchange(tried_, {});
    for (const FamilyFit& fit : whole) {
      FilterSpec spec = fit.fitted.filter;
      const double at = spec.pair_delay;
      const auto squares = [&](double delay) {
        spec.pair_delay = delay;
        return squares_of(spec, 1);
      };
      spec.pair_delay = golden_least(squares, std::max(1.0, at - 1.0), at + 1.0);
      offer(SettingFamily::shaper, spec, fit.fitted.parameters + 1, 1);
    }
    keep(most_others);
  }

  const FitWindow& window_;
  int order_max_, pole_order_max_;
  double period_;
  Reading reading_;
  std::vector<FamilyFit> tried_, kept_;
};

}  // namespace

std::vector<FamilyFit> fitted_families(const FitWindow& window, int order_max, int pole_order_max, double period,
                                       Ends ends, bool whole) {
  return FamilyFits(window, order_max, pole_order_max, period, ends).run(whole);
}

}  // namespace accdec
