#pragma once

#include <functional>
#include <span>
#include <vector>

#include <accdec/families/cascade.hpp>
#include <accdec/families/tap_range.hpp>
#include <accdec/family.hpp>
#include <accdec/task/tap_bounds.hpp>

namespace accdec {

/// Speeds at which one axis starts along leg 1 and stops along leg 2, m/s.
struct LegSpeeds {
  const Axis* axis;
  double start, stop;
};

/// Internal to the room: refuses filters by their taps, before their motion is looked at. It remembers where the last
/// ones broke a limit, because neighbours mostly break it there, too.
class QuickRefusals {
 public:
  /// @param on_taps  limits on the taps themselves, see limits_on_taps; the reference is kept
  /// @param smoothing  the control's own, behind every filter
  /// @param behind  limits on the taps behind the smoothing
  QuickRefusals(const Task& on_taps, std::vector<double> smoothing, const Task& behind);

  /// Whether a cascade's lengths alone tell: the plateau, the first step, the vibration at a few frequencies.
  bool refuses(std::span<const int> lengths, const FilterSpec& spec);
  /// Whether an exponential's first taps, its largest, are too large. False for other shapes.
  bool refuses_first_taps(const FilterSpec& spec) const;
  /// Whether it breaks a limit where the last one did that broke one.
  bool fails_likewise(const Cascade& cascade) const;
  /// Whether a filter may start every leg and stop it: what most do not, and the cheapest to see on taps not yet
  /// divided by their sum.
  bool starts(std::span<const double> taps, double sum);
  /// Whether a tap is too large, or a mode rings. @param late  asked again and again; once true the answer is of no use
  bool refuses(const Filter& filter, const std::function<bool()>& late);

  double tap_max() const { return bounds_.most; }
  /// Frequencies at which filters were found to ring, the last first.
  const std::vector<Tone>& tones() const { return tones_; }

 private:
  struct Place {
    const LegSpeeds* speeds = nullptr;
    int sample = 0;
  };
  /// Whether the largest step between two taps lasts for as many of them as the smoothing has taps, before the second
  /// impulse comes. Then the smoothing leaves it as it is.
  bool step_stays(std::span<const int> lengths, const FilterSpec& spec) const;
  bool rings(std::span<const int> lengths, const FilterSpec& spec);
  /// Whether a tap behind the smoothing, or a step between two, is too large.
  bool refused_behind(std::span<const double> taps, double sum);
  bool start_holds(const LegSpeeds& speeds, double tap, double gone) const;
  bool stop_holds(const LegSpeeds& speeds, double tap, double left) const;

  const Task& on_taps_;
  TapBounds bounds_;
  std::vector<double> smoothing_;  ///< {1} where there is none
  TapBounds bounds_behind_;
  std::vector<double> behind_;  ///< taps behind the smoothing of the last filter
  std::vector<LegSpeeds> speeds_;
  Place failed_start_, failed_stop_;  ///< where the last filter that could not start or stop broke a limit
  std::vector<Tone> tones_;
};

}  // namespace accdec
