#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

#include <accdec/design/fit_window.hpp>
#include <accdec/nlp/nonnegative.hpp>

namespace accdec {
namespace {

constexpr int rest_kept = 20, steady_kept = 20;  // samples beside a ramp

/// q(m) = sum_i b_i max(m - i, 0) for m = 0 .. N + 1: full-speed samples that a leg has moved.
std::vector<double> moved(const Filter& filter) {
  std::vector<double> way(static_cast<std::size_t>(filter.order()) + 2, 0.0);
  double gone = 0.0;
  for (int i = 0; i <= filter.order(); ++i) {
    gone += filter.tap(i);
    way[static_cast<std::size_t>(i) + 1] = way[static_cast<std::size_t>(i)] + gone;
  }
  return way;
}

double moved_at(const std::vector<double>& way, int m) {
  if (m <= 0) return 0.0;
  const int last = static_cast<int>(way.size()) - 1;
  return m <= last ? way[static_cast<std::size_t>(m)] : way.back() + (m - last);
}

}  // namespace

FitWindow::FitWindow(const MotionLog& log, const LoggedCommand& command, int order_max) : log_(log), command_(command) {
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

CommandFit FitWindow::fit_at(const std::vector<double>& reached, const std::vector<int>& first,
                             const std::vector<int>& count) const {
  const auto rows = static_cast<Eigen::Index>(rows_.size()), legs = static_cast<Eigen::Index>(first.size());
  Eigen::MatrixXd basis(rows, legs + 1);
  basis.col(0).setOnes();
  for (Eigen::Index s = 0; s < legs; ++s) {
    const int begin = first[static_cast<std::size_t>(s)], n = count[static_cast<std::size_t>(s)];
    for (Eigen::Index r = 0; r < rows; ++r) {
      const int k = rows_[static_cast<std::size_t>(r)];
      basis(r, s + 1) = (moved_at(reached, k - begin) - moved_at(reached, k - begin - n)) / n;
    }
  }
  CommandFit fit{0.0, first, count, {}};
  fit.coefficients = (basis.transpose() * basis).ldlt().solve(basis.transpose() * at_);
  fit.squares = (at_ - basis * fit.coefficients).squaredNorm();
  return fit;
}

CommandFit FitWindow::fit(const Filter& filter, int around) const {
  const std::vector<double> reached = moved(filter);
  const std::size_t legs = command_.legs.size();
  std::vector<int> first, count;
  for (const LoggedCommand::Leg& leg : command_.legs) {
    count.push_back(std::max(1, static_cast<int>(std::lround(leg.last - leg.first))));
    first.push_back(static_cast<int>(std::lround(leg.first - filter.mean_delay())));
  }
  CommandFit best = fit_at(reached, first, count);
  // Coordinate by coordinate: each number is known to a fraction of a sample.
  for (bool better = around > 0; better;) {
    better = false;
    for (std::size_t i = 0; i < 2 * legs; ++i) {
      for (const int step : {-1, 1}) {
        std::vector<int> f = best.first, n = best.count;
        const std::size_t leg = i / 2;
        (i % 2 == 0 ? f : n)[leg] += step;
        if (n[leg] < 1 || std::abs(f[leg] - first[leg]) > around || std::abs(n[leg] - count[leg]) > around) continue;
        CommandFit tried = fit_at(reached, f, n);
        if (tried.squares < best.squares) best = std::move(tried), better = true;
      }
    }
  }
  return best;
}

std::vector<std::vector<double>> FitWindow::model(const Filter& filter, const CommandFit& fit) const {
  const std::vector<double> reached = moved(filter);
  std::vector<std::vector<double>> positions;
  for (std::size_t a = 0; a < log_.axes.size(); ++a) {
    const auto axis = static_cast<Eigen::Index>(a);
    std::vector<double>& position = positions.emplace_back(log_.samples(), fit.coefficients(0, axis));
    for (std::size_t k = 0; k < position.size(); ++k) {
      for (std::size_t s = 0; s < fit.first.size(); ++s) {
        const int m = static_cast<int>(k) - fit.first[s];
        position[k] += fit.coefficients(static_cast<Eigen::Index>(s) + 1, axis) *
                       (moved_at(reached, m) - moved_at(reached, m - fit.count[s])) / fit.count[s];
      }
    }
  }
  return positions;
}

Filter FitWindow::free_taps(const CommandFit& fit, int order) const {
  const auto rows = static_cast<Eigen::Index>(rows_.size()), axes = at_.cols();
  Eigen::MatrixXd a(rows * axes, order + 1);
  Eigen::VectorXd b(rows * axes);
  for (Eigen::Index axis = 0; axis < axes; ++axis) {
    for (Eigen::Index r = 0; r < rows; ++r) {
      const int k = rows_[static_cast<std::size_t>(r)];
      b(axis * rows + r) = at_(r, axis) - fit.coefficients(0, axis);
      for (int i = 0; i <= order; ++i) {
        double way = 0.0;
        for (std::size_t s = 0; s < fit.first.size(); ++s) {
          const int m = k - fit.first[s] - i;
          way += fit.coefficients(static_cast<Eigen::Index>(s) + 1, axis) *
                 (std::max(m, 0) - std::max(m - fit.count[s], 0)) / fit.count[s];
        }
        a(axis * rows + r, i) = way;
      }
    }
  }
  const double scale = a.cwiseAbs().maxCoeff();
  const Eigen::VectorXd taps =
      nlp::nonnegative_least_squares(a / scale, b / scale, std::vector<char>(static_cast<std::size_t>(order) + 1, 1));
  return Filter({taps.data(), taps.data() + taps.size()});
}

}  // namespace accdec
