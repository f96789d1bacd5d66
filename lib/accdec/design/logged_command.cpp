#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include <accdec/design/logged_command.hpp>

namespace accdec {
namespace {

constexpr int rest_least = log_rest_least;
constexpr int steady_least = 6;                       // samples at constant speed in a leg
constexpr double least_way = 1e-3;                    // of the longest leg; an axis that moves less rests
constexpr double least_noise = 1e-4;                  // of a sample's step; less cannot be told from a log's last digit
constexpr double rounded_root = 0.28867513459481287;  // 1 / sqrt(12): the standard deviation of rounding to a step
constexpr double standing_part = 0.15;                // of a leg's samples; a control at constant speed stands in none
constexpr double moving_part = 0.1;                   // of the fastest sample's step: slower ends may be a pole's
constexpr double steady_part = 2e-3;  // of a sample's step, by which positions may be off a constant speed

class Finder {
 public:
  explicit Finder(const MotionLog& log) : axes_(static_cast<Eigen::Index>(log.axes.size())) {
    const auto samples = static_cast<Eigen::Index>(log.samples());
    at_.resize(axes_, samples);
    for (Eigen::Index a = 0; a < axes_; ++a) {
      const std::vector<double>& position = log.position[static_cast<std::size_t>(a)];
      at_.row(a) = Eigen::Map<const Eigen::RowVectorXd>(position.data(), samples);
    }
  }

  LoggedCommand run() {
    if (at_.cols() < log_samples_least)
      throw std::invalid_argument(
          fmt::format("the log has {} samples; allowed are {} or more", at_.cols(), log_samples_least));
    find_rests();
    LoggedCommand found;
    found.start = start_;
    found.moving_first = first_;
    found.moving_last = last_;
    const int corner = turning();
    if (corner < 0) {
      const Steady whole = steady(first_, last_);
      add(found, whole, start_, end_);
      weigh({whole}, found);
      found.longest_ramp = std::max(whole.first - first_, last_ - whole.last);
      return found;
    }
    const Steady in = steady(first_, corner), out = steady(corner, last_);
    const Eigen::VectorXd meet = meeting(in, out);
    add(found, in, start_, meet);
    add(found, out, meet, end_);
    weigh({in, out}, found);
    found.longest_ramp = std::max({in.first - first_, out.first - in.last, last_ - out.last});
    return found;
  }

 private:
  /// Samples first .. last at constant speed: position = from + k speed.
  struct Steady {
    int first = 0, last = 0;
    Eigen::VectorXd from, speed;
  };

  void find_rests() {
    const auto samples = static_cast<int>(at_.cols());
    start_ = at_.leftCols(rest_least).rowwise().mean();
    end_ = at_.rightCols(rest_least).rowwise().mean();
    way_ = (end_ - start_).norm();
    double noise = 0.0;
    for (int k = 0; k < rest_least; ++k)
      noise = std::max({noise, (at_.col(k) - start_).norm(), (at_.col(samples - 1 - k) - end_).norm()});
    if (!(way_ > 100.0 * noise) || !(way_ > 0.0))
      throw std::invalid_argument(fmt::format(
          "the log must begin and end at rest, {} samples each, at different places: it ends {:.4g} mm from where it "
          "begins, and moves by up to {:.4g} mm in its first and last {} samples",
          rest_least, 1e3 * way_, 1e3 * noise, rest_least));
    require_rest("begins", 0);
    require_rest("ends", samples - rest_least);
    resolution_ = resolution();
    threshold_ = threshold(noise);
    while (first_ + 1 < samples && (at_.col(first_ + 1) - start_).norm() <= threshold_) ++first_;
    last_ = samples - 1;
    while (last_ > 0 && (at_.col(last_ - 1) - end_).norm() <= threshold_) --last_;
  }

  /// A log that begins amid a ramp moves far less there than on its whole way, but as fast as elsewhere. Noise has no
  /// direction.
  void require_rest(const char* does, int from) const {
    const Eigen::VectorXd way = at_.col(from + rest_least - 1) - at_.col(from);
    for (int k = from + 1; k < from + rest_least; ++k) {
      if (!(way.dot(at_.col(k) - at_.col(k - 1)) > 0.0)) return;
    }
    const double fastest = (at_.rightCols(at_.cols() - 1) - at_.leftCols(at_.cols() - 1)).colwise().norm().maxCoeff();
    const double part = way.norm() / (rest_least - 1) / fastest;
    if (part > moving_part)
      throw std::invalid_argument(fmt::format(
          "the log must begin and end at rest, {} samples each: it {} in motion, at {:.2g} of its fastest speed",
          rest_least, does, part));
  }

  /// m; what moves by less rests.
  double threshold(double noise) const { return std::max({4.0 * noise, 1e-5 * way_, 1.5 * resolution_}); }

  /// The mean square, m^2, of an axis' noise by first differences while it rests. The others' noise may hide where it
  /// begins to move.
  double square_at_rest(Eigen::Index a) const {
    const Eigen::Index samples = at_.cols();
    double noise = 0.0;
    for (Eigen::Index k = 0; k < rest_least; ++k)
      noise = std::max({noise, std::abs(at_(a, k) - start_(a)), std::abs(at_(a, samples - 1 - k) - end_(a))});
    const double still = threshold(noise);
    double squares = 0.0;
    long rests = 0;
    const auto add = [&](Eigen::Index k) { squares += std::pow(at_(a, k) - at_(a, k - 1), 2), ++rests; };
    Eigen::Index k = 1;
    for (; k < samples && std::abs(at_(a, k) - start_(a)) <= still; ++k) add(k);
    for (Eigen::Index back = samples - 1; back > k && std::abs(at_(a, back - 1) - end_(a)) <= still; --back) add(back);
    return squares / (2.0 * static_cast<double>(std::max(1L, rests)));
  }

  /// m, the smallest change of an axis, where it may be the log's last digit.
  double resolution() const {
    double least = std::numeric_limits<double>::infinity(), most = 0.0;
    for (Eigen::Index k = 1; k < at_.cols(); ++k) {
      for (Eigen::Index a = 0; a < axes_; ++a) {
        const double change = std::abs(at_(a, k) - at_(a, k - 1));
        if (change > 0.0) least = std::min(least, change);
        most = std::max(most, change);
      }
    }
    constexpr double digit = 0.02;  // of the fastest step; averages of fewer taps have no smaller changes
    return least < digit * most ? least : 0.0;
  }

  /// m, the largest 1, 2 or 5 times a power of ten of which all positions of an axis are multiples. 0: there is none,
  /// or an exact motion may have it.
  double written_step(Eigen::Index a) const {
    constexpr double exact = 1e-4, coarse = 0.5;
    const double fastest =
        (at_.row(a).rightCols(at_.cols() - 1) - at_.row(a).leftCols(at_.cols() - 1)).cwiseAbs().maxCoeff();
    for (int power = 0; power >= -12; --power) {
      for (const double digit : {5.0, 2.0, 1.0}) {
        const double step = digit * std::pow(10.0, power);
        if (step >= coarse * fastest) continue;
        const Eigen::ArrayXd steps = at_.row(a).transpose().array() / step;
        if ((steps - steps.round()).abs().maxCoeff() < exact) return step;
      }
    }
    return 0.0;
  }

  /// The sample farthest from the line between both ends; -1 for a straight move.
  int turning() const {
    const Eigen::VectorXd along = (end_ - start_) / way_;
    double farthest = std::max(10.0 * threshold_, 1e-3 * way_);
    int turning = -1;
    for (int k = first_; k <= last_; ++k) {
      const Eigen::VectorXd from = at_.col(k) - start_;
      const double off = (from - along.dot(from) * along).norm();
      if (off > farthest) farthest = off, turning = k;
    }
    return turning;
  }

  /// The longest part of a leg around its middle at constant speed.
  Steady steady(int from, int to) const {
    const double half = 0.5 * (at_.col(to) - at_.col(from)).norm();
    int middle = from;
    while (middle < to && (at_.col(middle) - at_.col(from)).norm() < half) ++middle;
    Steady part{middle - steady_least / 2, middle + steady_least / 2, {}, {}};
    if (part.first < from || part.last > to || !fits(part)) too_short(from, to);
    // Doubled on both sides while it stays straight and even, then sample by sample.
    for (int step = std::max(1, (to - from) / 4); step >= 1; step /= 2) {
      for (bool grown = true; grown;) {
        grown = false;
        for (const int side : {-1, 1}) {
          Steady longer = part;
          (side < 0 ? longer.first : longer.last) += side * step;
          if (longer.first < from || longer.last > to || !fits(longer)) continue;
          part = longer;
          grown = true;
        }
      }
    }
    // The samples taken last may already be part of a ramp.
    const int margin = (part.last - part.first) / 16;
    part.first += margin, part.last -= margin;
    fits(part);
    return part;
  }

  /// Fits a constant speed. @return whether the part keeps to it
  bool fits(Steady& part) const {
    const int count = part.last - part.first + 1;
    const auto block = at_.middleCols(part.first, count);
    const double centre = 0.5 * (part.first + part.last);
    const Eigen::VectorXd mean = block.rowwise().mean();
    Eigen::VectorXd moment = Eigen::VectorXd::Zero(axes_);
    double squares = 0.0;
    for (int k = 0; k < count; ++k) {
      const double t = part.first + k - centre;
      moment += t * block.col(k);
      squares += t * t;
    }
    part.speed = moment / squares;
    part.from = mean - centre * part.speed;
    double worst = 0.0;
    for (int k = 0; k < count; ++k)
      worst = std::max(worst, (block.col(k) - part.from - (part.first + k) * part.speed).norm());
    return part.speed.norm() > 0.0 && worst <= std::max(threshold_, steady_part * part.speed.norm());
  }

  /// m, by axis. Differences do not see a filter's slow end: first ones at rest, second ones at constant speed.
  Eigen::VectorXd noise_in(const std::vector<Steady>& parts) const {
    Eigen::ArrayXd at_rest(axes_), steady = Eigen::ArrayXd::Zero(axes_);
    for (Eigen::Index a = 0; a < axes_; ++a) at_rest(a) = square_at_rest(a);
    long steadies = 0;
    for (const Steady& part : parts) {
      for (int k = part.first + 1; k < part.last; ++k)
        steady += (at_.col(k + 1) - 2.0 * at_.col(k) + at_.col(k - 1)).array().square(), ++steadies;
    }
    return at_rest.max(steady / (6.0 * static_cast<double>(std::max(1L, steadies)))).sqrt();
  }

  /// The noise of every axis, and what its differences count.
  void weigh(const std::vector<Steady>& parts, LoggedCommand& found) const {
    Eigen::VectorXd noise = noise_in(parts);
    Eigen::VectorXd way = Eigen::VectorXd::Zero(axes_);
    for (const LoggedCommand::Leg& leg : found.legs) way = way.cwiseMax(leg.way.cwiseAbs());
    found.weights = Eigen::VectorXd::Zero(axes_);
    double squares = 0.0, told_apart = 0.0, rounded = 0.0;
    for (Eigen::Index a = 0; a < axes_; ++a) {
      if (way(a) < least_way * way.maxCoeff()) continue;
      // Neither rest nor constant speed shows the rounding if every sample moves by whole steps.
      const double least_of_step = rounded_root * written_step(a);
      noise(a) = std::max(noise(a), least_of_step), rounded += least_of_step * least_of_step;
      const double least = std::max(noise(a), least_noise * found.step);
      squares += noise(a) * noise(a), told_apart += least * least;
      found.weights(a) = 1.0 / least;
    }
    const auto moving = static_cast<double>(found.axes());
    found.noise = std::sqrt(squares / moving);
    found.rounding = std::sqrt(rounded / moving);
    found.weights *= std::sqrt(told_apart / moving);
  }

  [[noreturn]] void too_short(int from, int to) const {
    // Between the ramps a log of a faster clock repeats the control's positions.
    const int quarter = (to - from) / 4, middle = std::max(1, to - from - 2 * quarter);
    int still = 0, run = 0, longest = 0;
    for (int k = from + quarter + 1; k <= to - quarter; ++k) {
      run = (at_.col(k) - at_.col(k - 1)).norm() <= threshold_ ? run + 1 : 0;
      still += run > 0;
      longest = std::max(longest, run);
    }
    // A faster clock spreads what it repeats over the whole leg.
    if (still > standing_part * middle && 2 * longest > still)
      throw std::invalid_argument(
          fmt::format("the positions rest for {} samples amid samples {} to {}, between two moves; allowed is one "
                      "straight move, or one corner that is cut",
                      longest, from, to));
    if (still > standing_part * middle)
      throw std::invalid_argument(
          fmt::format("the positions stand still in {} of {} samples amid the leg from sample {} to {}: the log is "
                      "faster than the control; allowed is one row a sample period of the control",
                      still, middle, from, to));
    throw std::invalid_argument(fmt::format(
        "no part of the leg from sample {} to {} has a constant speed: the move must be longer than the filter", from,
        to));
  }

  /// The point where the extended legs come nearest to each other.
  Eigen::VectorXd meeting(const Steady& in, const Steady& out) const {
    const Eigen::VectorXd u = in.speed.normalized(), w = out.speed.normalized(), gap = out.from - in.from;
    const double c = u.dot(w), d = 1.0 - c * c;
    const double s = (gap.dot(u) - c * gap.dot(w)) / d, t = (c * gap.dot(u) - gap.dot(w)) / d;
    return 0.5 * (in.from + s * u + out.from + t * w);
  }

  static void add(LoggedCommand& found, const Steady& part, const Eigen::VectorXd& from, const Eigen::VectorXd& to) {
    const double square = part.speed.squaredNorm();
    const auto passes = [&](const Eigen::VectorXd& point) { return (point - part.from).dot(part.speed) / square; };
    found.legs.push_back({passes(from), passes(to), to - from});
    found.step = std::max(found.step, std::sqrt(square));
  }

  Eigen::Index axes_;
  Eigen::MatrixXd at_;
  Eigen::VectorXd start_, end_;
  double way_ = 0.0, resolution_ = 0.0, threshold_ = 0.0;
  int first_ = 0, last_ = 0;
};

}  // namespace

LoggedCommand logged_command(const MotionLog& log) {
  return Finder(log).run();
}

}  // namespace accdec
