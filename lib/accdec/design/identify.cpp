#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include <accdec/design/fit_window.hpp>
#include <accdec/design/identify.hpp>
#include <accdec/families/settable_search.hpp>

namespace accdec {
namespace {

/// A fit takes part in the comparison with free taps up to this factor on their noise: these have many more numbers.
constexpr double noise_more = 1.33;
/// Part of a sample's way that a fit may leave.
constexpr double unexplained = 0.1;
constexpr double noise_least = 1e-12;  // m; rounding
constexpr double sure = 20.0;          // of a logarithm of likelihoods, twice
/// Part of a sample's way that a family may leave more than free taps: smoothing that was measured is as exact.
constexpr double model_part = 1e-4;
constexpr double fastest = 20.0;  // m/s; no axis of a machine tool comes near it

struct Candidate {
  FittedFilter fitted;
  double squares = 0.0;
};

class Identifier {
 public:
  Identifier(const MotionLog& log, const Task& task, const IdentifyOptions& options)
      : log_(log),
        task_(task),
        options_(options),
        command_(logged_command(log)),
        // The noise, and cascades that begin slowly, hide where a ramp begins and ends.
        order_max_(std::min(task.design.order_max, command_.longest_ramp * 8 / 5 + 10)),
        window_(log, command_, order_max_, task.machine.prefilter_taps) {}

  Identification run() {
    require_believable();
    look();
    const double whole = least_squares();
    const std::vector<Candidate> candidates = all_;
    const FittedFilter taps = taps_;
    window_.allow_last_steps(true);
    look();
    // Last steps are more numbers to fit: they must explain more.
    const double values = static_cast<double>(window_.values());
    const double numbers = static_cast<double>(command_.legs.size() * log_.axes.size());
    if (values * std::log(whole / least_squares()) < numbers * std::log(values) + sure) {
      window_.allow_last_steps(false);
      all_ = candidates, taps_ = taps;
    }
    return answer();
  }

 private:
  /// All candidates, and free taps.
  void look() {
    all_.clear();
    if (asked(SettingFamily::averages)) averages();
    if (asked(SettingFamily::one_pole)) pole();
    refine();
    taps();
  }
  double least_squares() const {
    const double rounding = noise_least * noise_least * static_cast<double>(window_.values());
    return std::max(rounding, all_.empty() ? taps_squares_ : std::min(taps_squares_, all_.front().squares));
  }

  void require_believable() const {
    for (const Axis& axis : task_.machine.axes) {
      if (axis.servo_gain < unlimited || !axis.response_taps.empty())
        throw std::invalid_argument(
            "identify does not consider the servo of an axis (servo_gain_1_s, response_taps); leave it out, and what "
            "is found is filter and servo together");
    }
    const double feed = command_.step / task_.sample_period;
    if (feed > fastest)
      throw std::invalid_argument(
          fmt::format("the log moves at {:.4g} m/s; allowed are {:g} m/s: are the units of the "
                      "positions right?",
                      feed, fastest));
  }

  bool asked(SettingFamily family) const {
    if (!task_.settings || !task_.settings->names_family()) return true;
    const auto& families = task_.settings->families;
    return std::find(families.begin(), families.end(), family) != families.end();
  }
  std::size_t stages_max() const {
    return task_.settings && task_.settings->names_family() ? task_.settings->stages.size() : 3;
  }

  void offer(SettingFamily family, const FilterSpec& spec, int parameters) {
    Candidate candidate;
    candidate.fitted.family = family;
    candidate.fitted.filter = spec;
    candidate.fitted.parameters = parameters;
    candidate.squares = window_.fit(make_filter(spec), 0).squares;
    all_.push_back(std::move(candidate));
  }

  /// Every cascade of averages, longest first; an average of one tap is none.
  void averages() {
    std::vector<int> lengths;
    const std::function<void(int)> add = [&](int left) {
      const int longest = lengths.empty() ? left + 1 : std::min(left + 1, lengths.back());
      for (int length = lengths.empty() ? 1 : 2; length <= longest; ++length) {
        lengths.push_back(length);
        FilterSpec spec{.kind = Shape::averages, .lengths = lengths};
        for (const int l : lengths) spec.order += l - 1;
        offer(SettingFamily::averages, spec, static_cast<int>(lengths.size()));
        // A third stage only where two of nearly this kind fit: there are a hundred times as many.
        if (length > 1 && lengths.size() < std::min<std::size_t>(2, stages_max())) add(left - (length - 1));
        lengths.pop_back();
      }
    };
    add(order_max_);
    if (stages_max() > 2) third_stages();
  }

  /// Three averages with the mean and about the variance of the best two.
  void third_stages() {
    const auto best = std::min_element(all_.begin(), all_.end(),
                                       [](const Candidate& a, const Candidate& b) { return a.squares < b.squares; });
    const double variance = variance_of(best->fitted.filter.lengths);
    for (int a = 2; a <= order_max_; ++a) {
      for (int b = 2; b <= a; ++b) {
        for (int c = 2; c <= b && a + b + c - 3 <= order_max_; ++c) {
          if (std::abs(variance_of({a, b, c}) - variance) > 0.02 * variance + 2.0) continue;
          offer(SettingFamily::averages, {.kind = Shape::averages, .order = a + b + c - 3, .lengths = {a, b, c}}, 3);
        }
      }
    }
  }
  static double variance_of(const std::vector<int>& lengths) {
    double sum = 0.0;
    for (const int length : lengths) sum += (length * static_cast<double>(length) - 1.0) / 12.0;
    return sum;
  }

  /// By time constants a part in a hundred apart, then golden section.
  void pole() {
    const auto squares = [&](double constant) { return window_.fit(make_filter(cut_pole(constant)), 1).squares; };
    double best = 0.5, least = std::numeric_limits<double>::infinity();
    constexpr double step = 1.02;
    for (double constant = 0.3; cut_pole(constant).order <= std::max(order_max_, 5 * command_.longest_ramp);
         constant *= step) {
      if (const double found = squares(constant); found < least) least = found, best = constant;
    }
    const double golden = 0.5 * (std::sqrt(5.0) - 1.0);
    double low = best / step, high = best * step;
    for (int i = 0; i < 30; ++i) {
      const double left = high - golden * (high - low), right = low + golden * (high - low);
      (squares(left) < squares(right) ? high : low) = squares(left) < squares(right) ? right : left;
    }
    offer(SettingFamily::one_pole, cut_pole(0.5 * (low + high)), 1);
    all_.back().fitted.time_constant = 0.5 * (low + high) * task_.sample_period;
  }

  /// The most promising are fitted with commands that begin and end a sample earlier or later, too.
  void refine() {
    if (all_.empty()) return;
    sort();
    all_.resize(std::min<std::size_t>(all_.size(), 300));
    for (Candidate& candidate : all_) candidate.squares = window_.fit(make_filter(candidate.fitted.filter), 2).squares;
    sort();
  }
  void sort() {
    std::stable_sort(all_.begin(), all_.end(),
                     [](const Candidate& a, const Candidate& b) { return a.squares < b.squares; });
  }

  double rms(double squares, int parameters) const {
    const double free = static_cast<double>(window_.values()) - parameters -
                        static_cast<double>((command_.legs.size() + 1) * log_.axes.size());
    return std::sqrt(squares / std::max(1.0, free));
  }

  void taps() {
    // A command that begins early enough for every first tap.
    const FilterSpec wide{.kind = Shape::boxcar, .order = order_max_};
    const Filter like = all_.empty() ? make_filter(wide) : make_filter(all_.front().fitted.filter);
    CommandFit fit = window_.fit(like, 2);
    const int early = std::max(2, order_max_ / 8);
    for (int& first : fit.first) first -= early;
    // Ways are refitted with the taps, and taps with these ways: those of the family's fit make up for its taps.
    Filter found = window_.free_taps(fit, like.order() + 2 * early);
    constexpr int most_rounds = 30;
    for (int round = 0; round < most_rounds; ++round) {
      const double before = fit.squares;
      fit = window_.refit(found, fit);
      if (round > 0 && fit.squares > 0.99 * before) break;
      found = window_.free_taps(fit, like.order() + 2 * early);
    }
    std::vector<double> taps(found.taps().begin(), found.taps().end());
    // A tap is a second difference of positions, which has about the noise times the root of six.
    const double least =
        std::clamp(5.0 * rms(window_.fit(found, 2).squares, found.order() + 1) / command_.step, 1e-6, 1e-3);
    const auto counts = [=](double tap) { return tap >= least; };
    while (taps.size() > 1 && !counts(taps.back())) taps.pop_back();
    const auto begins = std::find_if(taps.begin(), taps.end(), counts);
    taps.erase(taps.begin(), begins);
    const Filter trimmed(taps);
    taps_.family = SettingFamily::taps;
    taps_.filter = {
        .kind = Shape::taps, .order = trimmed.order(), .taps = {trimmed.taps().begin(), trimmed.taps().end()}};
    taps_.parameters = trimmed.order() + 1;
    taps_squares_ = window_.fit(trimmed, 2).squares;
    taps_.rms = rms(taps_squares_, taps_.parameters);
  }

  Identification answer() {
    Identification result;
    result.taps = taps_;
    const double best = all_.empty() ? std::numeric_limits<double>::infinity() : rms(all_.front().squares, 1);
    if (std::min(best, taps_.rms) > unexplained * command_.step)
      throw std::invalid_argument(
          fmt::format("the log is no straight move and no corner from rest to rest, or has too much noise: the best "
                      "fit leaves {:.4g} um rms; allowed are {:.4g} um, a part of {:g} of a sample's way",
                      1e6 * std::min(best, taps_.rms), 1e6 * unexplained * command_.step, unexplained));
    const double more = noise_least + model_part * command_.step + options_.noise.value_or(0.0);
    if (best > noise_more * taps_.rms + more) {
      result.fits = {taps_};
      result.noise = options_.noise.value_or(taps_.rms);
    } else {
      result.noise = std::max(options_.noise.value_or(best), noise_least);
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

  /// More stages must explain more: a stage counts as much as its part of the Bayesian criterion.
  std::vector<FittedFilter> likely(double noise) {
    const double size = std::log(static_cast<double>(window_.values()));
    const auto cost = [&](const Candidate& c) { return c.squares / (noise * noise) + c.fitted.parameters * size; };
    std::stable_sort(all_.begin(), all_.end(),
                     [&](const Candidate& a, const Candidate& b) { return cost(a) < cost(b); });
    const double least = cost(all_.front());
    double sum = 0.0;
    for (const Candidate& c : all_) sum += std::exp(-0.5 * (cost(c) - least));
    std::vector<FittedFilter> fits;
    for (Candidate& c : all_) {
      const double worse = cost(c) - least;
      if (worse > options_.sigmas * options_.sigmas) break;
      c.fitted.sigmas = std::sqrt(worse);
      c.fitted.likelihood = std::exp(-0.5 * worse) / sum;
      c.fitted.rms = rms(c.squares, c.fitted.parameters);
      fits.push_back(c.fitted);
    }
    return fits;
  }

  const MotionLog& log_;
  const Task& task_;
  const IdentifyOptions& options_;
  LoggedCommand command_;
  int order_max_;
  FitWindow window_;
  std::vector<Candidate> all_;
  FittedFilter taps_;
  double taps_squares_ = 0.0;
};

}  // namespace

Identification identify(const MotionLog& log, const Task& task, const IdentifyOptions& options) {
  return Identifier(log, task, options).run();
}

}  // namespace accdec
