#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include <accdec/design/fit_window.hpp>
#include <accdec/design/fitted_families.hpp>
#include <accdec/design/identify.hpp>
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
constexpr long least_free = 10;   // values more than numbers to fit
constexpr double fastest = 20.0;  // m/s; no axis of a machine tool comes near it

void require_believable(const Task& task, double step) {
  for (const Axis& axis : task.machine.axes) {
    if (axis.servo_gain < unlimited || !axis.response_taps.empty())
      throw std::invalid_argument(
          "identify does not consider the servo of an axis (servo_gain_1_s, response_taps); leave it out, and what "
          "is found is filter and servo together");
  }
  const double feed = step / task.sample_period;
  if (feed > fastest)
    throw std::invalid_argument(
        fmt::format("the log moves at {:.4g} m/s; allowed are {:g} m/s: are the units of the "
                    "positions right?",
                    feed, fastest));
}

bool same_taps(const Filter& a, const Filter& b) {
  return std::ranges::equal(a.taps(), b.taps(), [](double x, double y) { return std::abs(x - y) < 1e-6; });
}

class Identifier {
 public:
  Identifier(const MotionLog& log, const Task& task, const IdentifyOptions& options)
      : task_(task),
        options_(options),
        command_(command_in(log, options)),
        // The noise, and cascades that begin slowly, hide where a ramp begins and ends.
        order_max_(std::min(task.design.order_max, command_.longest_ramp * 8 / 5 + 10)),
        window_(log, command_, order_max_, task.machine.prefilter_taps) {}

  Identification run() {
    require_believable(task_, command_.step);
    look();
    const double whole = least_squares();
    const std::vector<FamilyFit> members = all_;
    const FittedFilter taps = taps_;
    window_.allow_last_steps(true);
    look();
    // Last steps are more numbers to fit: they must explain more.
    const double values = static_cast<double>(window_.values());
    const double numbers = static_cast<double>(command_.legs.size()) * static_cast<double>(command_.axes());
    if (values * std::log(whole / least_squares()) < numbers * std::log(values) + sure) {
      window_.allow_last_steps(false);
      all_ = members, taps_ = taps;
    }
    return answer();
  }

 private:
  /// A given noise is that of all axes.
  static LoggedCommand command_in(const MotionLog& log, const IdentifyOptions& options) {
    LoggedCommand command = logged_command(log);
    if (options.noise) command.weights = (command.weights.array() > 0.0).cast<double>();
    return command;
  }
  /// Members of all families, and free taps.
  void look() {
    const int pole_order_max = std::max(order_max_, 5 * command_.longest_ramp);
    const auto members = [&](bool whole) {
      return fitted_families(window_, order_max_, pole_order_max, task_.sample_period, whole);
    };
    all_ = members(true);
    taps();
    if (fits_as_well_as_taps()) return;
    const std::vector<FamilyFit> between = members(false);
    all_.insert(all_.end(), between.begin(), between.end());
    std::stable_sort(all_.begin(), all_.end(),
                     [](const FamilyFit& a, const FamilyFit& b) { return a.squares < b.squares; });
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
    const double numbers = taps_.parameters, values = static_cast<double>(window_.values());
    const double least = std::max(taps_rms(), least_noise());
    const auto explained = [&](double count, double by) {
      return (count + deviations * std::sqrt(2.0 * count)) * by * by;
    };
    // Every ramp of every axis may be rounded alike: then taps explain the rounding of all.
    const auto ramps = static_cast<double>(2 * command_.legs.size()) * static_cast<double>(command_.axes());
    const double chance = std::max(explained(numbers, least), explained(ramps * numbers, rounded()));
    return best_rms() <= noise_more * least + rounding() + cut_off() &&
           best_rms() <= far_more * noise() + rounding() + speed_error() &&
           all_.front().squares <= taps_squares_ + chance + values * (rounding() * rounding() + cut_off() * cut_off());
  }
  /// m: an endless pole has no part at constant speed, so that the log's speed is known less well.
  double speed_error() const { return endless() ? 5e-3 * command_.step : 0.0; }
  bool endless() const { return all_.front().fitted.family == SettingFamily::one_pole; }
  /// m: the way that an endless pole has left where its family cuts it off, and a log does not.
  double cut_off() const {
    if (!endless()) return 0.0;
    const FittedFilter& best = all_.front().fitted;
    return pole_rest * (best.time_constant + best.second_constant) / task_.sample_period * command_.step;
  }
  double least_squares() const {
    const double least = noise_least * noise_least * static_cast<double>(window_.values());
    return std::max(least, std::min(taps_squares_, all_.front().squares));
  }

  double rms(double squares, int parameters) const {
    const double free = static_cast<double>(window_.values()) - parameters -
                        static_cast<double>(command_.legs.size() + 1) * static_cast<double>(command_.axes());
    return std::sqrt(squares / std::max(1.0, free));
  }

  double taps_rms() const { return rms(taps_squares_, taps_.parameters); }

  void taps() {
    // A command that begins early enough for every first tap.
    const Filter like = make_filter(all_.front().fitted.filter);
    CommandFit fit = window_.fit(like, 2);
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
    const auto ends = std::find_if(taps.rbegin(), taps.rend(), counts).base();
    // The others must make up for the taps that are left out.
    for (int& first : fit.first) first += static_cast<int>(begins - taps.begin());
    const Filter trimmed = window_.free_taps(fit, static_cast<int>(ends - begins) - 1);
    taps_.family = SettingFamily::taps;
    taps_.filter = {
        .kind = Shape::taps, .order = trimmed.order(), .taps = {trimmed.taps().begin(), trimmed.taps().end()}};
    taps_.parameters = trimmed.order() + 1;
    const CommandFit best = window_.fit(trimmed, 2);
    taps_squares_ = best.squares;
    taps_.rms = window_.figure(best, taps_.parameters);
  }

  Identification answer() {
    Identification result;
    result.taps = taps_;
    result.log_noise = command_.noise;
    const double best = best_rms();
    result.rounding = rounded();
    if (std::min(best, taps_rms()) > unexplained * command_.step)
      throw std::invalid_argument(
          fmt::format("the log is no straight move and no corner from rest to rest, or has too much noise: the best "
                      "fit leaves {:.4g} um rms; allowed are {:.4g} um, a part of {:g} of a sample's way",
                      1e6 * std::min(best, taps_rms()), 1e6 * unexplained * command_.step, unexplained));
    if (!fits_as_well_as_taps()) {
      result.fits = {taps_};
      result.noise = std::max(options_.noise.value_or(taps_rms()), least_noise());
    } else {
      result.noise = std::max(options_.noise.value_or(best), least_noise());
      result.fits = likely(result.noise);
    }
    const Filter filter = make_filter(result.fits.front().filter);
    const CommandFit fit = window_.fit(filter, 2);
    result.modelled = window_.model(filter, fit);
    const auto legs = static_cast<Eigen::Index>(fit.first.size());
    for (Eigen::Index s = 0; s < legs; ++s) {
      const auto leg = static_cast<std::size_t>(s);
      Eigen::VectorXd way = fit.coefficients.row(s + 1);
      LoggedMove move{.first = fit.first[leg], .samples = fit.count[leg]};
      if (fit.coefficients.rows() > legs + 1) {
        const Eigen::VectorXd last = fit.coefficients.row(legs + s + 1);
        move.last_step = last.dot(way) * move.samples / way.squaredNorm();
        ++move.samples;
        way += last;
      }
      move.way.assign(way.data(), way.data() + way.size());
      result.moves.push_back(std::move(move));
    }
    return result;
  }

  /// More numbers must explain more: each counts as much as its part of the Bayesian criterion.
  std::vector<FittedFilter> likely(double noise) {
    const double size = std::log(static_cast<double>(window_.values()));
    const auto cost = [&](const FamilyFit& c) { return c.squares / (noise * noise) + c.fitted.parameters * size; };
    std::stable_sort(all_.begin(), all_.end(),
                     [&](const FamilyFit& a, const FamilyFit& b) { return cost(a) < cost(b); });
    const double least = cost(all_.front());
    double sum = 0.0;
    std::vector<FittedFilter> fits;
    std::vector<Filter> filters;
    for (FamilyFit& c : all_) {
      const double worse = cost(c) - least;
      if (worse > options_.sigmas * options_.sigmas) break;
      // Two families can say the same: an average of 12 with impulses 12 samples apart is one of 24.
      const Filter filter = make_filter(c.fitted.filter);
      if (std::ranges::any_of(filters, [&](const Filter& other) { return same_taps(filter, other); })) continue;
      filters.push_back(filter);
      c.fitted.sigmas = std::sqrt(worse);
      c.fitted.likelihood = std::exp(-0.5 * worse);
      c.fitted.rms = window_.figure(window_.fit(filter, 2), c.fitted.parameters);
      sum += c.fitted.likelihood;
      fits.push_back(c.fitted);
    }
    for (FittedFilter& fit : fits) fit.likelihood /= sum;
    return fits;
  }

  const Task& task_;
  const IdentifyOptions& options_;
  LoggedCommand command_;
  int order_max_;
  FitWindow window_;
  std::vector<FamilyFit> all_;
  FittedFilter taps_;
  double taps_squares_ = 0.0;
};

}  // namespace

Identification identify(const MotionLog& log, const Task& task, const IdentifyOptions& options) {
  return Identifier(log, task, options).run();
}

}  // namespace accdec
