#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include <accdec/design/fit_window.hpp>
#include <accdec/design/fitted_families.hpp>
#include <accdec/design/identify.hpp>
#include <accdec/design/likely_fits.hpp>
#include <accdec/families/poles.hpp>

namespace accdec {
namespace {

/// A fit takes part in the comparison with free taps up to this factor on their noise: these have many more numbers.
constexpr double noise_more = 1.33;
/// Part of a sample's way that a fit may leave.
constexpr double unexplained = 0.1;
constexpr double noise_least = 1e-12;  // m; rounding
constexpr double exact_part = 0.01;    // of the log's rounding; a fit that leaves less has no part of it
constexpr double sure = 20.0;          // of a logarithm of likelihoods, twice
/// Part of a sample's way that a family may leave more than free taps: smoothing that was measured is as exact.
constexpr double model_part = 1e-4;
constexpr long least_free = 10;  // values more than numbers to fit

void require_believable(const Task& task, double step) {
  for (const Axis& axis : task.machine.axes) {
    if (axis.servo_gain < unlimited || !axis.response_taps.empty())
      throw std::invalid_argument(
          "identify does not consider the servo of an axis (servo_gain_1_s, response_taps); leave it out, and what "
          "is found is filter and servo together");
  }
  const double feed = step / task.sample_period;
  if (feed > fastest_move)
    throw std::invalid_argument(
        fmt::format("the log moves at {:.4g} m/s; allowed are {:g} m/s: are the units of the "
                    "positions right?",
                    feed, fastest_move));
}

constexpr std::array all_ends{Ends::whole, Ends::between, Ends::last, Ends::both};

void sort_by_squares(std::vector<FamilyFit>& fits) {
  std::stable_sort(fits.begin(), fits.end(),
                   [](const FamilyFit& a, const FamilyFit& b) { return a.squares < b.squares; });
}

/// A given noise is that of all axes.
LoggedCommand command_in(const MotionLog& log, const IdentifyOptions& options) {
  LoggedCommand command = logged_command(log);
  if (options.noise) command.weights = (command.weights.array() > 0.0).cast<double>();
  return command;
}

/// Taps and the command in front of them.
struct FittedTaps {
  FittedFilter fitted{};
  CommandFit fit{};
};

class Identifier {
 public:
  Identifier(const MotionLog& log, const Task& task, const IdentifyOptions& options)
      : task_(task),
        options_(options),
        command_(command_in(log, options)),
        // The noise, and cascades that begin slowly, hide where a ramp begins and ends.
        order_max_(std::min(task.design.order_max, command_.longest_ramp * 8 / 5 + 10)),
        window_(log, command_, order_max_, task.machine.prefilter_taps),
        list_(log, task, options, command_, window_) {}

  Identification run() {
    require_believable(task_, command_.step);
    for (const Ends ends : all_ends) look(ends, true);
    taps_ = taps();
    exchange();
    if (!fits_as_well_as_taps()) {
      for (const Ends ends : all_ends) look(ends, false);
      exchange();
    }
    return answer();
  }

 private:
  /// Members of all families.
  void look(Ends ends, bool whole) {
    const int pole_order_max = std::max(order_max_, 5 * command_.longest_ramp);
    const std::vector<FamilyFit> members =
        fitted_families(window_, order_max_, pole_order_max, task_.sample_period, ends, whole);
    all_.insert(all_.end(), members.begin(), members.end());
    sort_by_squares(all_);
  }
  /// Readings of the same members with other moves.
  void exchange() {
    std::erase_if(all_, [](const FamilyFit& member) { return member.reading.samples > 0; });
    const std::vector<FamilyFit> exchanged = exchanged_moves(window_, all_, task_.design.order_max);
    all_.insert(all_.end(), exchanged.begin(), exchanged.end());
    sort_by_squares(all_);
  }
  /// Taps behind legs with shorter last steps, if these explain much more than their numbers by chance.
  FittedTaps taps() const {
    const FittedTaps whole = taps(Ends::whole), shorter = taps(Ends::last);
    const auto values = static_cast<double>(window_.values());
    const double least = noise_least * noise_least * values;
    const double numbers = numbers_of(Ends::last, static_cast<int>(command_.legs.size()));
    const double ratio = std::max(least, whole.fit.squares) / std::max(least, shorter.fit.squares);
    return values * std::log(ratio) < numbers * std::log(values) + sure ? whole : shorter;
  }
  double best_rms() const { return rms(all_.front().squares, 1); }
  /// m: what neither family nor taps need explain.
  double rounding() const { return noise_least + model_part * command_.step; }
  double noise() const { return std::max(command_.noise, least_noise()); }
  double least_noise() const { return std::max({noise_least, options_.noise.value_or(0.0), rounded()}); }
  /// m. Rounding looks like free taps, but not like a family: one that is exact shows a log without any.
  double rounded() const { return best_rms() < exact_part * command_.rounding ? 0.0 : command_.rounding; }
  /// Free taps explain more by chance: of as many numbers as they have more, each about the noise's square. Several
  /// standard deviations beyond that, the family is not the log's. Nor is it where it leaves far more than the noise.
  bool fits_as_well_as_taps() const {
    constexpr double far_more = 3.0, deviations = 4.0;
    const double numbers = taps_.fitted.parameters, values = static_cast<double>(window_.values());
    const double least = std::max(taps_rms(), least_noise());
    const auto explained = [&](double count, double by) {
      return (count + deviations * std::sqrt(2.0 * count)) * by * by;
    };
    // An endless pole has no part at constant speed, so that the log's speed is known less well.
    const double speed_error = endless() ? 5e-3 * command_.step : 0.0;
    // Every ramp of every axis may be rounded alike: then taps explain the rounding of all.
    const auto ramps = static_cast<double>(2 * command_.legs.size()) * static_cast<double>(command_.axes());
    const double chance = std::max(explained(numbers, least), explained(ramps * numbers, rounded()));
    return best_rms() <= noise_more * least + rounding() + cut_off() &&
           best_rms() <= far_more * noise() + rounding() + speed_error &&
           all_.front().squares <=
               taps_.fit.squares + chance + values * (rounding() * rounding() + cut_off() * cut_off());
  }
  bool endless() const { return all_.front().fitted.family == SettingFamily::one_pole; }
  /// m: the way that an endless pole has left where its family cuts it off, and a log does not.
  double cut_off() const {
    if (!endless()) return 0.0;
    const FittedFilter& best = all_.front().fitted;
    return pole_rest * (best.time_constant + best.second_constant) / task_.sample_period * command_.step;
  }
  double rms(double squares, int parameters) const {
    const double free = static_cast<double>(window_.values()) - parameters -
                        static_cast<double>(command_.legs.size() + 1) * static_cast<double>(command_.axes());
    return std::sqrt(squares / std::max(1.0, free));
  }

  double taps_rms() const { return rms(taps_.fit.squares, taps_.fitted.parameters); }

  FittedTaps taps(Ends ends) const {
    // A command that begins early enough for every first tap.
    const Filter like = make_filter(all_.front().fitted.filter);
    CommandFit fit = window_.fit(like, 2, {.ends = ends, .samples = 0});
    const int early = std::max(2, order_max_ / 8);
    if (const long numbers = like.order() + 2 * early + 2; window_.values() < numbers + least_free)
      throw std::invalid_argument(fmt::format(
          "the log has too few samples to tell filters apart: {} values near its ramps for {} taps; allowed "
          "are {} or more",
          window_.values(), numbers, numbers + least_free));
    for (int& first : fit.first) first -= early;
    const Filter found = window_.free_taps(fit, like.order() + 2 * early);
    const std::vector<double> taps(found.taps().begin(), found.taps().end());
    // A tap is a second difference of positions, which has about the noise times the root of six.
    const double small = std::clamp(5.0 * rms(fit.squares, found.order() + 1) / command_.step, 1e-6, 1e-3);
    const double least = std::min(small, *std::ranges::max_element(taps));
    const auto counts = [=](double tap) { return tap >= least; };
    const auto begins = std::find_if(taps.begin(), taps.end(), counts);
    const auto behind_last = std::find_if(taps.rbegin(), taps.rend(), counts).base();
    // The others must make up for the taps that are left out.
    for (int& first : fit.first) first += static_cast<int>(begins - taps.begin());
    const Filter trimmed = window_.free_taps(fit, static_cast<int>(behind_last - begins) - 1);
    FittedTaps result;
    result.fit = window_.fit(trimmed, 2, {.ends = ends, .samples = 0});
    FittedFilter& fitted = result.fitted;
    fitted.family = SettingFamily::taps;
    fitted.filter = {
        .kind = Shape::taps, .order = trimmed.order(), .taps = {trimmed.taps().begin(), trimmed.taps().end()}};
    fitted.parameters = trimmed.order() + 1;
    fitted.rms = window_.figure(trimmed, result.fit, fitted.parameters);
    fitted.moves = moves_of(result.fit);
    return result;
  }

  Identification answer() {
    Identification result;
    result.taps = taps_.fitted;
    result.log_noise = command_.noise;
    const double best = best_rms();
    result.rounding = rounded();
    if (std::min(best, taps_rms()) > unexplained * command_.step)
      throw std::invalid_argument(
          fmt::format("the log is no straight move and no corner from rest to rest, or has too much noise: the best "
                      "fit leaves {:.4g} um rms; allowed are {:.4g} um, a part of {:g} of a sample's way",
                      1e6 * std::min(best, taps_rms()), 1e6 * unexplained * command_.step, unexplained));
    if (!fits_as_well_as_taps()) {
      result.fits = {taps_.fitted};
      best_fit_ = taps_.fit;
      result.noise = std::max(options_.noise.value_or(taps_rms()), least_noise());
    } else {
      result.noise = std::max(options_.noise.value_or(best), least_noise());
      LikelyFits likely = list_.likely(std::move(all_), result.noise);
      result.fits = std::move(likely.fits), best_fit_ = std::move(likely.first);
    }
    result.modelled = window_.model(make_filter(result.fits.front().filter), best_fit_);
    return result;
  }

  const Task& task_;
  const IdentifyOptions& options_;
  LoggedCommand command_;
  int order_max_;
  FitWindow window_;
  FitList list_;
  std::vector<FamilyFit> all_;
  FittedTaps taps_;
  CommandFit best_fit_;
};

}  // namespace

double delay_between(const LoggedMove& in, const LoggedMove& out) {
  // With a short first step the log has another clock; its last step is then no whole sample of the control.
  const double last = in.first_step < 1.0 ? in.last_step : 1.0;
  return out.first + 1.0 - out.first_step - (in.first + in.samples - 1.0 + last);
}

Identification identify(const MotionLog& log, const Task& task, const IdentifyOptions& options) {
  return Identifier(log, task, options).run();
}

}  // namespace accdec
