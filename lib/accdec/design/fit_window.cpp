#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include <Eigen/Cholesky>

#include <accdec/design/compared_samples.hpp>
#include <accdec/design/fit_window.hpp>
#include <accdec/motion/convolved.hpp>
#include <accdec/nlp/nonnegative.hpp>

namespace accdec {
namespace {

constexpr int rest_kept = 20, steady_kept = 20;  // samples beside a ramp

/// The part of a leg's full steps that it has moved.
/// @param at  d: full-speed samples that it has moved d samples later, one number or one of every sample
template <class Value, class At>
Value part_moved(const At& at, int count, int later = 0) {
  return (at(later) - at(later - count)) / count;
}

/// Additions to the full steps of a leg.
enum class Addition { later, first_step, last_step };

std::vector<Addition> additions(Ends ends) {
  switch (ends) {
    case Ends::whole: return {};
    case Ends::between: return {Addition::later};
    case Ends::last: return {Addition::last_step};
    case Ends::both: return {Addition::first_step, Addition::last_step};
  }
  return {};
}

/// Motion of a whole addition, as `part_moved`: a sample more of delay, or a full step more.
template <class Value, class At>
Value added(const At& at, int count, Addition addition) {
  if (addition == Addition::later) return part_moved<Value>(at, count, -1) - part_moved<Value>(at, count);
  const int later = addition == Addition::last_step ? -count - 1 : 0;
  return (at(later + 1) - at(later)) / count;
}

/// The part of its full steps that a leg of a fit has moved in sample k.
double part_moved(const Filter& filter, int k, const CommandFit& fit, std::size_t leg) {
  const int m = k - fit.first[leg], count = fit.count[leg];
  const auto at = [&](int later) { return filter.elapsed_moment(m + later); };
  double part = part_moved<double>(at, count);
  Eigen::Index row = 0;
  for (const Addition addition : additions(fit.ends))
    part += fit.parts(row++, static_cast<Eigen::Index>(leg)) * added<double>(at, count, addition);
  return part;
}

/// Start and ways of the full steps, in a basis that begins with them and has the additions behind them.
Eigen::MatrixXd joined_parts(const Eigen::MatrixXd& parts) {
  const Eigen::Index legs = parts.cols();
  Eigen::MatrixXd joined = Eigen::MatrixXd::Zero(1 + legs * (1 + parts.rows()), 1 + legs);
  joined.topRows(1 + legs).setIdentity();
  for (Eigen::Index kind = 0; kind < parts.rows(); ++kind) {
    for (Eigen::Index leg = 0; leg < legs; ++leg) joined(1 + legs * (1 + kind) + leg, 1 + leg) = parts(kind, leg);
  }
  return joined;
}

Filter behind(const Filter& filter, const Filter& smoothing) {
  return smoothing.order() == 0 ? filter : Filter(convolved(filter.taps(), smoothing.taps()));
}

constexpr int most_legs = 2, most_numbers = 1 + 3 * most_legs;  // start, and of a leg its way and two additions
/// Small matrices of normal equations, without allocations.
using Normal = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, most_numbers, most_numbers>;

/// The parts that a filter bends in all commands near one.
/// @param around  how many samples each number may be off; ends may add one
std::vector<BentPart> bent_near(const Filter& filter, const std::vector<int>& first, const std::vector<int>& count,
                                int around) {
  std::vector<BentPart> bent;
  for (std::size_t leg = 0; leg < first.size(); ++leg) {
    const int last = first[leg] + count[leg];
    bent.push_back({first[leg] - around - 1, first[leg] + around + 1 + filter.order()});
    bent.push_back({last - 2 * around - 1, last + 2 * around + 1 + filter.order()});
  }
  return bent;
}

}  // namespace

FitWindow::FitWindow(const MotionLog& log, const LoggedCommand& command, int order_max,
                     const std::vector<double>& smoothing)
    : log_(log), command_(command), smoothing_(smoothing.empty() ? std::vector{1.0} : smoothing) {
  order_max += smoothing_.order();
  const auto samples = static_cast<int>(log.samples());
  const auto near_event = [&](int k) {
    return std::any_of(command.legs.begin(), command.legs.end(), [&](const LoggedCommand::Leg& leg) {
      for (const double event : {leg.first, leg.last}) {
        if (std::abs(k - event) <= order_max + steady_kept) return true;
      }
      return false;
    });
  };
  for (int k = 0; k < samples; ++k) {
    if (k < command.moving_first - rest_kept || k > command.moving_last + rest_kept) continue;
    if (near_event(k)) rows_.push_back(k);
  }
  at_.resize(static_cast<Eigen::Index>(rows_.size()), static_cast<Eigen::Index>(log.axes.size()));
  for (std::size_t a = 0; a < log.axes.size(); ++a) {
    for (std::size_t r = 0; r < rows_.size(); ++r)
      at_(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(a)) =
          log.position[a][static_cast<std::size_t>(rows_[r])];
  }
}

CommandFit FitWindow::fit_at(ComparedSamples& samples, const std::vector<int>& first, const std::vector<int>& count,
                             Ends ends, double slack) const {
  const auto legs = static_cast<Eigen::Index>(first.size());
  const std::vector<Addition> more = additions(ends);
  const auto kinds = static_cast<Eigen::Index>(more.size());
  const Eigen::MatrixXd& positions = samples.at();
  Eigen::MatrixXd basis(positions.rows(), 1 + legs * (1 + kinds));
  basis.col(0) = samples.ones();
  for (Eigen::Index s = 0; s < legs; ++s) {
    const int begin = first[static_cast<std::size_t>(s)], length = count[static_cast<std::size_t>(s)];
    const auto at = [&](int later) -> const Eigen::VectorXd& { return samples.from(begin - later); };
    basis.col(1 + s) = part_moved<Eigen::VectorXd>(at, length);
    for (Eigen::Index kind = 0; kind < kinds; ++kind)
      basis.col(1 + legs * (1 + kind) + s) = added<Eigen::VectorXd>(at, length, more[static_cast<std::size_t>(kind)]);
  }
  CommandFit fit;
  fit.first = first, fit.count = count, fit.ends = ends;
  // Products of columns: general products of matrices cost more than these small ones.
  Eigen::MatrixXd normal(basis.cols(), basis.cols()), right(basis.cols(), at_.cols());
  for (Eigen::Index i = 0; i < basis.cols(); ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) normal(i, j) = normal(j, i) = basis.col(i).dot(basis.col(j));
    for (Eigen::Index axis = 0; axis < at_.cols(); ++axis) right(i, axis) = basis.col(i).dot(positions.col(axis));
  }
  fit.parts = parts_of(normal, right, legs, kinds, ends == Ends::between, slack);
  const Normal joined = joined_parts(fit.parts);
  fit.coefficients = Normal(joined.transpose() * normal * joined).ldlt().solve(joined.transpose() * right);
  const Eigen::MatrixXd ways = joined * fit.coefficients;
  for (Eigen::Index axis = 0; axis < at_.cols(); ++axis) {
    const double weight = command_.weights[axis];
    if (!(weight > 0.0)) continue;
    fit.squares +=
        weight * weight *
        (samples.beside_lines()[axis] + (positions.col(axis) - basis.lazyProduct(ways.col(axis))).squaredNorm());
  }
  return fit;
}

Eigen::MatrixXd FitWindow::parts_of(const Eigen::MatrixXd& normal, const Eigen::MatrixXd& right, Eigen::Index legs,
                                    Eigen::Index kinds, bool alike, double slack) const {
  Eigen::MatrixXd parts = Eigen::MatrixXd::Zero(kinds, legs);
  std::vector<Eigen::Index> open;  // parts that are not at an end of their range
  for (Eigen::Index i = 0; i < kinds * legs; ++i) open.push_back(i);
  while (!open.empty()) {
    Normal joined(normal.rows(), 1 + legs + static_cast<Eigen::Index>(open.size()));
    joined.setZero();
    joined.leftCols(1 + legs) = joined_parts(parts);
    for (std::size_t i = 0; i < open.size(); ++i)
      joined(1 + legs + open[i], 1 + legs + static_cast<Eigen::Index>(i)) = 1;
    const Eigen::MatrixXd ways = Normal(joined.transpose() * normal * joined).ldlt().solve(joined.transpose() * right) *
                                 command_.weights.asDiagonal();
    // All axes of a leg share a part: the mean of those of the axes, by the squares of their ways.
    double over = 0.0, under = 0.0;
    std::vector<Eigen::Index> inside;
    for (std::size_t i = 0; i < open.size(); ++i) {
      const Eigen::Index leg = open[i] % legs;
      const double product = ways.row(1 + leg).dot(ways.row(1 + legs + static_cast<Eigen::Index>(i)));
      const double square = ways.row(1 + leg).squaredNorm(), part = product / square;
      over += product, under += square;
      parts(open[i] / legs, leg) = std::clamp(part, -slack, 1.0 + slack);
      if (part >= -slack && part <= 1.0 + slack) inside.push_back(open[i]);
    }
    if (alike) parts.setConstant(std::clamp(over / under, -slack, 1.0 + slack));
    if (alike || inside.size() == open.size()) break;
    for (const Eigen::Index i : inside) parts(i / legs, i % legs) = 0.0;
    open = std::move(inside);
  }
  return parts;
}

CommandFit FitWindow::refit(const Filter& filter, const CommandFit& fit) const {
  const Filter both = behind(filter, smoothing_);
  ComparedSamples samples(both, rows_, at_, bent_near(both, fit.first, fit.count, 0));
  return fit_at(samples, fit.first, fit.count, fit.ends, 0.0);
}

CommandFit FitWindow::fit(const Filter& designed, int around, const Reading& reading) const {
  const Filter filter = behind(designed, smoothing_);
  const std::size_t legs = command_.legs.size();
  std::vector<int> first, count;
  for (const LoggedCommand::Leg& leg : command_.legs) {
    const double length = leg.last - leg.first;
    count.push_back(reading.samples > 0 ? reading.samples : std::max(1, static_cast<int>(std::lround(length))));
    const double begins = leg.first + (reading.samples > 0 ? 0.5 * (length - reading.samples) : 0.0);
    first.push_back(static_cast<int>(std::lround(begins - filter.mean_delay())));
  }
  ComparedSamples samples(filter, rows_, at_, bent_near(filter, first, count, around));
  // A command that may not move to the sample where it begins has parts of steps in its place.
  CommandFit best = fit_at(samples, first, count, reading.ends, around > 0 ? 0.0 : 1.0);
  std::set<std::pair<std::vector<int>, std::vector<int>>> tried{{first, count}};
  // Coordinate by coordinate: each number is known to a fraction of a sample.
  for (bool better = around > 0; better;) {
    better = false;
    for (std::size_t i = 0; i < 2 * legs; ++i) {
      for (const int step : {-1, 1}) {
        std::vector<int> f = best.first, n = best.count;
        const std::size_t leg = i / 2;
        (i % 2 == 0 ? f : n)[leg] += step;
        if (n[leg] < 1 || std::abs(f[leg] - first[leg]) > around || std::abs(n[leg] - count[leg]) > around) continue;
        if (!tried.emplace(f, n).second) continue;
        CommandFit other = fit_at(samples, f, n, reading.ends, 0.0);
        if (other.squares < best.squares) best = std::move(other), better = true;
      }
    }
  }
  return best;
}

double FitWindow::figure(const Filter& filter, const CommandFit& fit, int parameters) const {
  const std::vector<std::vector<double>> modelled = model(filter, fit);
  const int length = filter.order() + smoothing_.order() + 2;
  double squares = 0.0;
  long acting = 0;
  for (const int k : rows_) {
    bool acts = false;
    for (std::size_t leg = 0; leg < fit.first.size(); ++leg) {
      const int begun = k - fit.first[leg], ended = begun - fit.count[leg];
      acts = acts || (begun > 0 && begun < length) || (ended > 0 && ended < length);
    }
    if (!acts) continue;
    acting += command_.axes();
    for (std::size_t a = 0; a < modelled.size(); ++a) {
      const auto sample = static_cast<std::size_t>(k);
      const double off = log_.position[a][sample] - modelled[a][sample];
      squares += std::pow(command_.weights[static_cast<Eigen::Index>(a)] * off, 2);
    }
  }
  const double part = static_cast<double>(acting) / static_cast<double>(values());
  const double numbers = static_cast<double>(command_.legs.size() + 1) * static_cast<double>(command_.axes());
  return std::sqrt(squares / std::max(1.0, static_cast<double>(acting) - parameters - part * numbers));
}

std::vector<std::vector<double>> FitWindow::model(const Filter& filter, const CommandFit& fit) const {
  const Filter both = behind(filter, smoothing_);
  std::vector<std::vector<double>> positions;
  for (std::size_t a = 0; a < log_.axes.size(); ++a) {
    const auto axis = static_cast<Eigen::Index>(a);
    std::vector<double>& position = positions.emplace_back(log_.samples(), fit.coefficients(0, axis));
    for (std::size_t k = 0; k < position.size(); ++k) {
      for (std::size_t leg = 0; leg < fit.first.size(); ++leg)
        position[k] += fit.coefficients(static_cast<Eigen::Index>(leg) + 1, axis) *
                       part_moved(both, static_cast<int>(k), fit, leg);
    }
  }
  return positions;
}

Filter FitWindow::taps_for(const CommandFit& fit, int order) const {
  const auto rows = static_cast<Eigen::Index>(rows_.size());
  Eigen::MatrixXd a(rows * command_.axes(), order + 1);
  Eigen::VectorXd b(a.rows());
  Eigen::Index row = 0;
  for (Eigen::Index axis = 0; axis < at_.cols(); ++axis) {
    const double weight = command_.weights(axis);
    if (!(weight > 0.0)) continue;
    for (Eigen::Index r = 0; r < rows; ++r, ++row) {
      const int k = rows_[static_cast<std::size_t>(r)];
      b(row) = weight * at_(r, axis);
      for (int i = 0; i <= order; ++i) {
        double way = 0.0;
        for (std::size_t leg = 0; leg < fit.first.size(); ++leg)
          way += fit.coefficients(static_cast<Eigen::Index>(leg) + 1, axis) * part_moved(smoothing_, k - i, fit, leg);
        a(row, i) = weight * way;
      }
    }
    // Without the means, any start of the axis fits.
    a.middleRows(row - rows, rows).rowwise() -= a.middleRows(row - rows, rows).colwise().mean().eval();
    b.segment(row - rows, rows).array() -= b.segment(row - rows, rows).mean();
  }
  const double scale = a.cwiseAbs().maxCoeff();
  const Eigen::VectorXd taps =
      nlp::nonnegative_least_squares(a / scale, b / scale, std::vector<char>(static_cast<std::size_t>(order) + 1, 1));
  return Filter({taps.data(), taps.data() + taps.size()});
}

Filter FitWindow::free_taps(CommandFit& fit, int order) const {
  constexpr int most_rounds = 300;
  constexpr double gain = 1e-5;
  Filter found = taps_for(fit, order);
  for (int round = 0; round < most_rounds; ++round) {
    const double before = fit.squares;
    fit = refit(found, fit);
    if (round > 0 && fit.squares > (1.0 - gain) * before) break;
    found = taps_for(fit, order);
  }
  return found;
}

}  // namespace accdec
