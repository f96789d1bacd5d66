#include <algorithm>
#include <cmath>

#include <accdec/plan/free/cone_program.hpp>

namespace accdec {
namespace {

constexpr int iterations_max = 60;
constexpr double accepted_violation = 5e-8;
// Per bound. The gap grows if no point is within the bounds.
constexpr double gap_min = 2e-8, gap_start = 0.1, hopeless = 1e5 * gap_start;

double change(const LinearForm& form, const std::vector<double>& d) {
  double sum = 0.0;
  for (int i = 0; i < form.count; ++i) sum += form.coefficient[i] * d[static_cast<std::size_t>(form.unknown[i])];
  return sum;
}

}  // namespace

void LinearForm::add(int index, double factor) {
  for (int i = 0; i < count; ++i) {
    if (unknown[i] != index) continue;
    coefficient[i] += factor;
    return;
  }
  unknown[count] = index;
  coefficient[count++] = factor;
}

ConeProgram::ConeProgram(std::size_t unknowns, std::size_t dimensions, std::size_t band)
    : unknowns_(unknowns), n_(dimensions), band_(band) {}

void ConeProgram::within(const LinearPoint& point, const double* a, const double* b, double radius) {
  Ball ball{};
  ball.point = point;
  for (std::size_t i = 0; i < n_; ++i) {
    ball.a[i] = a[i];
    ball.along[i] = b[i] - a[i];
    ball.length = std::hypot(ball.length, ball.along[i]);
  }
  for (std::size_t i = 0; i < n_ && ball.length > 0.0; ++i) ball.along[i] /= ball.length;
  ball.scale = 1.0 / radius;
  balls_.push_back(ball);
}

void ConeProgram::evaluate(const std::vector<double>& z) {
  for (Row& row : rows_) row.value = row.form.constant + change(row.form, z);
  for (Ball& ball : balls_) {
    std::array<double, program_axis_count> e{};
    double along = 0.0;
    for (std::size_t i = 0; i < n_; ++i) {
      double x = ball.point.constant[i] - ball.a[i];
      for (int j = 0; j < 2; ++j) {
        if (ball.point.sample[j] >= 0)
          x += ball.point.weight[j] * z[static_cast<std::size_t>(ball.point.sample[j]) + i];
      }
      if (ball.point.shifted) x += ball.point.shift[i] * z.back();
      e[i] = x;
      along += x * ball.along[i];
    }
    const double t = std::clamp(along, 0.0, ball.length);
    ball.beside = along > 0.0 && along < ball.length;
    double distance2 = 0.0;
    for (std::size_t i = 0; i < n_; ++i) {
      const double d = (e[i] - t * ball.along[i]) * ball.scale;
      distance2 += d * d;
      ball.gradient[i] = d * ball.scale;
    }
    ball.value = 0.5 * (distance2 - 1.0);
  }
}

void ConeProgram::start() {
  constexpr double least = 0.1, mu = gap_start;
  for (Row& row : rows_) {
    row.slack = {std::max(1.0 - row.value, least), std::max(1.0 + row.value, least)};
    row.dual = {mu / row.slack[0], mu / row.slack[1]};
  }
  for (Ball& ball : balls_) {
    ball.slack = std::max(-ball.value, least);
    ball.dual = mu / ball.slack;
  }
}

double ConeProgram::gap() const {
  double sum = 0.0;
  for (const Row& row : rows_) sum += row.slack[0] * row.dual[0] + row.slack[1] * row.dual[1];
  for (const Ball& ball : balls_) sum += ball.slack * ball.dual;
  return sum / static_cast<double>(2 * rows_.size() + balls_.size());
}

double ConeProgram::violation() const {
  double worst = 0.0;
  for (const Row& row : rows_) worst = std::max(worst, std::abs(row.value) - 1.0);
  for (const Ball& ball : balls_) worst = std::max(worst, ball.value);
  return worst;
}

void ConeProgram::assemble_ball(const Ball& ball) {
  const double w = ball.dual / ball.slack, curved = ball.dual * ball.scale * ball.scale;
  const auto last = static_cast<int>(unknowns_) - 1;
  const LinearPoint& p = ball.point;
  std::array<std::array<double, program_axis_count>, program_axis_count> h;
  for (std::size_t i = 0; i < n_; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      double value = w * ball.gradient[i] * ball.gradient[j];
      if (i == j) value += curved;
      if (ball.beside) value -= curved * ball.along[i] * ball.along[j];
      h[i][j] = h[j][i] = value;
    }
  }
  for (int s = 0; s < 2; ++s) {
    if (p.sample[s] < 0) continue;
    for (int t = 0; t <= s; ++t) {
      if (p.sample[t] < 0) continue;
      const double weight = p.weight[s] * p.weight[t];
      for (std::size_t i = 0; i < n_; ++i) {
        for (std::size_t j = 0; j < n_; ++j) {
          const int row = p.sample[s] + static_cast<int>(i), column = p.sample[t] + static_cast<int>(j);
          if (s != t || row >= column) entry(row, column) += weight * h[i][j];
        }
      }
    }
  }
  if (!p.shifted) return;
  for (std::size_t i = 0; i < n_; ++i) {
    double sum = 0.0;
    for (std::size_t j = 0; j < n_; ++j) sum += h[i][j] * p.shift[j];
    for (int s = 0; s < 2; ++s) {
      if (p.sample[s] >= 0) at(last, p.sample[s] + static_cast<int>(i)) += p.weight[s] * sum;
    }
    at(last, last) += p.shift[i] * sum;
  }
}

void ConeProgram::assemble() {
  matrix_.assign(unknowns_ * (band_ + 1), 0.0);
  for (const Row& row : rows_) {
    const double w = row.dual[0] / row.slack[0] + row.dual[1] / row.slack[1];
    for (int i = 0; i < row.form.count; ++i) {
      const double wi = w * row.form.coefficient[i];
      for (int j = 0; j <= i; ++j) entry(row.form.unknown[i], row.form.unknown[j]) += wi * row.form.coefficient[j];
    }
  }
  for (const Ball& ball : balls_) assemble_ball(ball);
}

/// Cholesky within the band.
bool ConeProgram::factor() {
  const std::size_t width = band_ + 1;
  for (std::size_t i = 0; i < unknowns_; ++i) {
    double* const li = &matrix_[i * width];
    const std::size_t from = i > band_ ? i - band_ : 0;
    for (std::size_t j = from; j < i; ++j) {
      const double* const lj = &matrix_[j * width];
      const std::size_t begin = std::max(from, j > band_ ? j - band_ : 0);
      double sum = li[i - j];
      for (std::size_t k = begin; k < j; ++k) sum -= li[i - k] * lj[j - k];
      li[i - j] = sum / lj[0];
    }
    double sum = li[0];
    for (std::size_t k = from; k < i; ++k) sum -= li[i - k] * li[i - k];
    if (!(sum > li[0] * 1e-15) || !(sum > 0.0)) {
      if (!std::isfinite(sum)) return false;
      sum = std::max(li[0], 1e-300) * 1e30;  // this unknown stays where it is
    }
    li[0] = std::sqrt(sum);
  }
  return true;
}

void ConeProgram::solve_factored(std::vector<double>& x) const {
  const std::size_t width = band_ + 1;
  for (std::size_t i = 0; i < unknowns_; ++i) {
    const double* const li = &matrix_[i * width];
    for (std::size_t k = i > band_ ? i - band_ : 0; k < i; ++k) x[i] -= li[i - k] * x[k];
    x[i] /= li[0];
  }
  for (std::size_t i = unknowns_; i-- > 0;) {
    const double* const li = &matrix_[i * width];
    x[i] /= li[0];
    for (std::size_t k = i > band_ ? i - band_ : 0; k < i; ++k) x[k] -= li[i - k] * x[i];
  }
}

double ConeProgram::ball_change(const Ball& ball, const std::vector<double>& d) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < n_; ++i) {
    double x = ball.point.shifted ? ball.point.shift[i] * d.back() : 0.0;
    for (int j = 0; j < 2; ++j) {
      if (ball.point.sample[j] >= 0) x += ball.point.weight[j] * d[static_cast<std::size_t>(ball.point.sample[j]) + i];
    }
    sum += ball.gradient[i] * x;
  }
  return sum;
}

void ConeProgram::add_ball_gradient(const Ball& ball, double factor, std::vector<double>& to) const {
  for (std::size_t i = 0; i < n_; ++i) {
    const double g = factor * ball.gradient[i];
    for (int j = 0; j < 2; ++j) {
      if (ball.point.sample[j] >= 0) to[static_cast<std::size_t>(ball.point.sample[j]) + i] += ball.point.weight[j] * g;
    }
    if (ball.point.shifted) to.back() += ball.point.shift[i] * g;
  }
}

/// One direction: s y is to become `centre`, less the product of the last direction's changes for the second order.
void ConeProgram::newton(double centre, bool second_order, bool maximise) {
  step_.assign(unknowns_, 0.0);
  if (maximise) step_.back() = 1.0;
  // A bound adds this to the right side, once its slack and dual are eliminated.
  const auto pull = [&](double value, double slack, double dual, double ds, double dy) {
    const double residual = value + slack;
    const double product = slack * dual - centre + (second_order ? ds * dy : 0.0);
    return dual + (dual * residual - product) / slack;
  };
  for (const Row& row : rows_) {
    const double up = pull(row.value - 1.0, row.slack[0], row.dual[0], row.dslack[0], row.ddual[0]);
    const double down = pull(-row.value - 1.0, row.slack[1], row.dual[1], row.dslack[1], row.ddual[1]);
    for (int i = 0; i < row.form.count; ++i)
      step_[static_cast<std::size_t>(row.form.unknown[i])] -= (up - down) * row.form.coefficient[i];
  }
  for (const Ball& ball : balls_)
    add_ball_gradient(ball, -pull(ball.value, ball.slack, ball.dual, ball.dslack, ball.ddual), step_);
  solve_factored(step_);
  const auto follow = [&](double value, double moved, double slack, double dual, double& ds, double& dy) {
    const double product = slack * dual - centre + (second_order ? ds * dy : 0.0);
    ds = -(value + slack) - moved;
    dy = (-product - dual * ds) / slack;
  };
  for (Row& row : rows_) {
    const double moved = change(row.form, step_);
    follow(row.value - 1.0, moved, row.slack[0], row.dual[0], row.dslack[0], row.ddual[0]);
    follow(-row.value - 1.0, -moved, row.slack[1], row.dual[1], row.dslack[1], row.ddual[1]);
  }
  for (Ball& ball : balls_)
    follow(ball.value, ball_change(ball, step_), ball.slack, ball.dual, ball.dslack, ball.ddual);
}

double ConeProgram::step_length() const {
  double most = 1.0;
  const auto limit = [&](double x, double dx) {
    if (dx < 0.0 && most * -dx > x) most = x / -dx;
  };
  for (const Row& row : rows_) {
    for (int i = 0; i < 2; ++i) {
      limit(row.slack[i], row.dslack[i]);
      limit(row.dual[i], row.ddual[i]);
    }
  }
  for (const Ball& ball : balls_) {
    limit(ball.slack, ball.dslack);
    limit(ball.dual, ball.ddual);
  }
  return most;
}

bool ConeProgram::solve(std::vector<double>& z, bool maximise) {
  evaluate(z);
  start();
  const double bounds = static_cast<double>(2 * rows_.size() + balls_.size());
  for (iterations_ = 0; iterations_ < iterations_max; ++iterations_) {
    const double mu = gap();
    const double broken = violation();
    if (broken <= accepted_violation && (!maximise || mu < gap_min)) return true;
    if (!(mu < hopeless)) return false;
    assemble();
    if (!factor()) return false;
    newton(0.0, false, maximise);
    const double affine = step_length();
    double sum = 0.0;
    const auto product = [&](double s, double y, double ds, double dy) {
      return (s + affine * ds) * (y + affine * dy);
    };
    for (const Row& row : rows_) {
      for (int i = 0; i < 2; ++i) sum += product(row.slack[i], row.dual[i], row.dslack[i], row.ddual[i]);
    }
    for (const Ball& ball : balls_) sum += product(ball.slack, ball.dual, ball.dslack, ball.ddual);
    const double ratio = std::max(0.0, sum / bounds) / mu;
    newton(mu * ratio * ratio * ratio, true, maximise);
    const double step = std::min(1.0, 0.99 * step_length());
    if (!(step > 1e-9)) return false;
    for (std::size_t i = 0; i < unknowns_; ++i) z[i] += step * step_[i];
    for (Row& row : rows_) {
      for (int i = 0; i < 2; ++i) {
        row.slack[i] += step * row.dslack[i];
        row.dual[i] += step * row.ddual[i];
      }
    }
    for (Ball& ball : balls_) {
      ball.slack += step * ball.dslack;
      ball.dual += step * ball.ddual;
    }
    evaluate(z);
    // Slacks that are smaller than what the bound leaves are no use.
    for (Ball& ball : balls_) ball.slack = std::max(ball.slack, -ball.value);
  }
  return false;
}

}  // namespace accdec
