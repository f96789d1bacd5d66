// Filters: taps b_i >= 0 of sum 1, the shapes they are made of, and filters as task files write them.
#pragma once

#include <cmath>
#include <optional>
#include <span>
#include <string_view>
#include <variant>
#include <vector>

namespace accdec {

/// The Acc/Dec processor: a non-negative FIR filter of order N acting on velocity commands (Shih, Chen, Lee, Eq.
/// 16-18).
///
/// Immutable. Taps are normalised to sum 1, which removes the paper's position convergent factor b_s. The corner model
/// needs four sequences of a filter, each tabulated once:
///   * cumulative(k), B_k = sum_{i<k} b_i: the step response, 0 for k <= 0 and 1 for k > N
///   * remaining(k), 1 - B_k = sum_{i>=k} b_i: summed from the far end, so that it is exactly 0 past the last tap
///   * elapsed_moment(m), Q(m) = sum_i b_i max(m - i, 0): distance gone m samples after a start, in full-speed samples
///   * remaining_moment(k), p(k) = sum_i b_i max(i - k, 0): distance left k samples after a stop was commanded
class Filter {
 public:
  /// @param taps  b_0 .. b_N, at least one, each finite and >= 0, positive sum; any scale.
  /// @throws std::invalid_argument naming the first offending tap.
  explicit Filter(std::vector<double> taps);
  /// The same with taps of either sign: how an axis moves behind a measured response. A negative tap makes B fall
  /// again, so searches by closed form (DelayFinder) do not take it.
  static Filter of_any_sign(std::vector<double> taps);

  /// N; the filter has N + 1 taps.
  int order() const { return static_cast<int>(taps_.size()) - 1; }
  std::span<const double> taps() const { return taps_; }
  /// b_i, 0 outside 0 .. N.
  double tap(int i) const { return i < 0 || i > order() ? 0.0 : taps_[static_cast<std::size_t>(i)]; }

  double cumulative(int k) const {
    if (k <= 0) return 0.0;
    return k > order() ? 1.0 : cumulative_[static_cast<std::size_t>(k)];
  }
  double remaining(int k) const {
    if (k <= 0) return 1.0;
    return k > order() ? 0.0 : remaining_[static_cast<std::size_t>(k)];
  }
  double elapsed_moment(int m) const {
    if (m <= 0) return 0.0;
    return m > order() ? m - mean_delay_ : elapsed_moment_[static_cast<std::size_t>(m)];
  }
  double remaining_moment(int k) const {
    if (k <= 0) return mean_delay_ - k;
    return k > order() ? 0.0 : remaining_moment_[static_cast<std::size_t>(k)];
  }

  /// Mean delay M = sum i b_i in samples; replaces N/2 of Eq. (20) for asymmetric taps.
  double mean_delay() const { return mean_delay_; }

  /// Index range [first, last] of the taps that are not exactly zero.
  int first_nonzero_tap() const { return first_nonzero_; }
  int last_nonzero_tap() const { return last_nonzero_; }

 private:
  Filter(std::vector<double> taps, bool any_sign);

  std::vector<double> taps_, cumulative_, remaining_, elapsed_moment_, remaining_moment_;
  double mean_delay_ = 0.0;
  int first_nonzero_ = 0, last_nonzero_ = 0;
};

/// Standard Acc/Dec shapes as filters of order N (N + 1 taps). All throw std::invalid_argument when an argument is out
/// of the range given here. Order 0 is the filter that passes the command through unchanged.

/// Equal taps: linear Acc/Dec. order >= 0.
Filter boxcar(int order);

/// Equal steps up, a plateau, equal steps down: b_i ~ min(i + 1, ramp + 1, N + 1 - i). Constant jerk, then constant
/// acceleration. @param ramp taps in each ramp below the plateau, 0 <= ramp <= N/2; 0 is the boxcar, floor(N/2) the
/// triangle.
Filter trapezoid(int order, int ramp);

/// Derivative of the quintic S-curve 10 t^3 - 15 t^4 + 6 t^5 at t = i/N, both zero end taps included (Eq. 30-32). order
/// >= 2.
Filter s_curve(int order);

/// Hann window 0.5 - 0.5 cos(2 pi i/N), end taps zero. order >= 2.
Filter hann(int order);

/// Blackman window 0.42 - 0.5 cos(2 pi i/N) + 0.08 cos(4 pi i/N), end taps zero. order >= 2.
Filter blackman(int order);

/// Blackman-windowed sinc low-pass, blackman(i) sinc(cutoff (i - N/2)), sinc(x) = sin(pi x)/(pi x): the paper's FIR
/// Acc/Dec.
/// @param cutoff  fraction of the Nyquist frequency, > 0; at most 2/N, where the sinc would turn negative inside the
/// window.
Filter blackman_sinc(int order, double cutoff);

/// More shapes that controllers offer. They throw in the same way.

/// Truncated exponential b_i ~ ratio^i, i = 0 .. N: "exponential Acc/Dec" with an end. order >= 0.
/// @param ratio  0 < ratio <= exponential_ratio_max. Below 1: a truncated one-pole filter. 1: the boxcar. Above 1: a
///               rising filter, whose start is as smooth as the stop of the falling one
inline constexpr double exponential_ratio_max = 1000.0;
Filter exponential(int order, double ratio);

inline constexpr double gaussian_alpha_max = 6.0;
/// Gaussian exp(-(alpha x)^2/2), x = (i - N/2)/(N/2) from -1 to 1. order >= 1.
/// @param alpha  half width over standard deviation, 0 <= alpha <= gaussian_alpha_max; 0 is the boxcar
Filter gaussian(int order, double alpha);

/// No controller has nearly as many averages, and every one costs a pass over all taps.
inline constexpr int averages_max = 2000;
/// The largest product of their number and the order: about a second of work.
inline constexpr double averages_work_max = 5e8;
/// Moving averages in series: the convolution of boxcars with these lengths in taps; N = sum (length - 1). Two make a
/// trapezoid.
/// @param lengths  1 to averages_max of them, each >= 1; see averages_work_max
Filter averages(std::span<const int> lengths);

/// The first and the last of three impulses of a ZVD shaper.
inline constexpr double zvd_outer = 0.25;

/// The taps of such a cascade followed by pairs (with_pairs), not yet divided by their sum. Without MZV and EI they are
/// whole numbers, exact up to 2^53. Their sum is 2^pairs times the product of the lengths. Beyond about 2^500 all are
/// scaled by the same power of two.
std::vector<double> cascade_taps(std::span<const int> lengths, int pairs, int delay, double outer = zvd_outer);

/// A filter followed by impulses `delay` samples apart. Equal pairs cancel an undamped vibration of period 2 delay T.
/// An impulse between two samples is split linearly onto them: a control that interpolates its command does the same.
/// Impulses within shaper_snap of a sample are at it.
/// @param pairs  how many pairs (1/2 now, 1/2 after the delay): 1 is the ZV shaper of two impulses, 2 the ZVD of three
///               (Singer and Seering, J. Dyn. Sys. Meas. Control 112, 1990), 0 leaves the filter as it is; 0 to 2
/// @param delay  samples, >= 1, need not be whole; the order grows by `pairs` times it, rounded up
/// @param outer  of three impulses, the first and the last: 0 < outer < 1/2
Filter with_pairs(const Filter& filter, int pairs, double delay, double outer = zvd_outer);
inline constexpr double shaper_snap = 1e-9;  ///< samples

/// An input shaper without damping: two or three impulses, equally far apart.
struct ShaperInfo {
  std::string_view name;   ///< in task files
  std::string_view title;  ///< for people
  int pairs;               ///< 1: two equal impulses, 2: three
  double outer;            ///< the first and the last of three
  double delay_periods;    ///< between impulses, in periods of the frequency to which it is set
};
/// ZV and ZVD; MZV as Klipper's klippy/extras/shaper_defs.py has it; EI, which leaves 5 % (Singhose, Seering, Singer,
/// J. Mech. Des. 116, 1994).
std::span<const ShaperInfo> shaper_list();
/// Null for a name that is none.
const ShaperInfo* find_shaper(std::string_view name);

/// The shapes in which a filter can be given. All code that depends on the list of shapes takes it from `shape_list`.
enum class Shape { boxcar, trapezoid, averages, s_curve, hann, blackman, blackman_sinc, gaussian, exponential, taps };

/// A filter as a task describes it.
struct FilterSpec {
  Shape kind = Shape::boxcar;
  int order = 0;               ///< N of the shape without pairs; for averages and taps it follows from these
  double cutoff = 0.0;         ///< blackman-sinc: fraction of the Nyquist frequency
  int ramp = 0;                ///< trapezoid: taps in a ramp
  std::vector<double> taps{};  ///< Shape::taps
  std::vector<int> lengths{};  ///< averages: taps of each
  double ratio = 0.0;          ///< exponential: ratio of each tap to the one before
  double alpha = 0.0;          ///< gaussian: half width over standard deviation
  int pairs = 0;             ///< any shape: number of pairs of impulses after it, see with_pairs: 0 none, 1 ZV, 2 three
  double pair_delay = 0.0;   ///< samples between the impulses of a pair; need not be whole
  double outer = zvd_outer;  ///< of three impulses, the first and the last: ZVD, MZV or EI

  bool whole_pairs() const { return pair_delay == static_cast<int>(pair_delay); }
  /// N of the filter with its pairs.
  int full_order() const { return order + static_cast<int>(std::ceil(pairs * pair_delay - shaper_snap)); }
};
/// The shaper behind a filter. Null: it has none.
const ShaperInfo* shaper_of(const FilterSpec& spec);

/// One parameter of a shape besides its order: its key in [filter], its member, its range.
struct ShapeParameter {
  using Member = std::variant<int FilterSpec::*, double FilterSpec::*, std::vector<int> FilterSpec::*,
                              std::vector<double> FilterSpec::*>;
  std::string_view key;
  Member member;
  double low, high;  ///< of each number; the shape's maker may allow less
  bool open_low;     ///< low itself is not allowed
};

/// A shape: its name in task files ("boxcar", "s-curve", ...), its title, whether `order` is given or follows from the
/// parameter, its parameter.
struct ShapeInfo {
  Shape shape;
  std::string_view name;
  std::string_view title;  ///< for tables and figures, which take it from here
  bool has_order;
  std::optional<ShapeParameter> parameter;
  Filter (*make)(const FilterSpec&);  ///< without pairs; throws std::invalid_argument
};

/// Every shape, in the order of the enumeration. Tables and messages use this order.
std::span<const ShapeInfo> shape_list();
const ShapeInfo& info(Shape shape);
std::string_view to_string(Shape shape);
std::optional<Shape> shape_from_string(std::string_view name);

/// The shape's title with the pairs behind it, "two averages, ZVD"; what the title says in parentheses stands only
/// without pairs.
std::string shape_title(Shape shape, int pairs = 0, double outer = zvd_outer);

/// The filter, with its pairs. @throws std::invalid_argument as the shapes do.
Filter make_filter(const FilterSpec& spec);

/// The parameters that set a filter apart within its family, in the words of task files: "ramp = 3",
/// "lengths = [8, 5, 2], ZV 12"; may be empty. Real parameters have four digits, for people; files that are read again
/// need all.
enum class Digits { four, all };
std::string describe_parameters(const FilterSpec& spec, Digits digits = Digits::four);

}  // namespace accdec
