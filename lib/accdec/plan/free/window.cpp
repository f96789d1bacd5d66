#include <algorithm>
#include <array>
#include <cmath>

#include <accdec/plan/free/cone_program.hpp>
#include <accdec/plan/free/window.hpp>

namespace accdec {
namespace {

/// Bounds of the program are narrower than those of the check by this part.
constexpr double inside = 1.0 - 1e-7;
/// Steps of a motion at its feed must have room, or no window keeps up with what follows it. The check grants 1e-6.
constexpr double above_feed = 1.0 + 2e-7;

class WindowProgram {
 public:
  WindowProgram(const FreePath& free, const Window& window)
      : free_(free),
        w_(window),
        n_(free.dimensions()),
        border_(static_cast<std::ptrdiff_t>(free.border())),
        size_(static_cast<std::ptrdiff_t>(window.size)),
        shift_(static_cast<int>(window.size * free.dimensions())),
        program_(window.size * n_ + 1, n_, free.border() * n_) {
    std::copy_n(window.before.end() - static_cast<std::ptrdiff_t>(n_), n_, origin_.begin());
    for (std::size_t a = 0; a < n_; ++a) add_axis(a);
    add_share();
    add_steps();
    add_tube();
    for (const WindowPass& pass : window.passes) add_pass(pass);
  }

  bool solve(std::vector<double>& guess, bool maximise, double& share) {
    std::vector<double> z(guess.size() + 1, 0.1);
    for (std::size_t i = 0; i < guess.size(); ++i) z[i] = guess[i] - origin_[i % n_];
    if (!program_.solve(z, maximise)) return false;
    for (std::size_t i = 0; i < guess.size(); ++i) guess[i] = z[i] + origin_[i % n_];
    share = std::clamp(z.back(), 0.0, 1.0);
    return true;
  }

 private:
  using Vector = std::array<double, program_axis_count>;

  /// Adds a multiple of a coordinate of sample k.
  void add(LinearForm& form, std::ptrdiff_t k, std::size_t a, double factor) const {
    if (k >= 0 && k < size_) return form.add(static_cast<int>(k) * static_cast<int>(n_) + static_cast<int>(a), factor);
    if (k < 0) {
      form.constant += factor * (w_.before[static_cast<std::size_t>(border_ + k) * n_ + a] - origin_[a]);
      return;
    }
    const std::size_t i = static_cast<std::size_t>(k - size_) * n_ + a;
    form.constant += factor * (w_.after[i] - origin_[a]);
    if (w_.later[i] != w_.after[i]) form.add(shift_, factor * (w_.later[i] - w_.after[i]));
  }

  void bound_difference(std::ptrdiff_t k, std::size_t a, const std::array<double, 4>& factors) {
    LinearForm form;
    for (std::ptrdiff_t j = 0; j < 4; ++j) {
      if (factors[static_cast<std::size_t>(j)] != 0.0) add(form, k - j, a, factors[static_cast<std::size_t>(j)]);
    }
    if (form.count > 0) program_.bound(form);
  }

  void add_axis(std::size_t a) {
    const Axis& axis = free_.machine.axes[a];
    const double rate = 1.0 / free_.period, v = rate / inside, acc = rate * rate / inside;
    for (std::ptrdiff_t k = 0; k < size_ + border_; ++k) {
      const double speed = feed(k);
      if (k <= size_ && axis.velocity_max < speed * (above_feed + 1e-6))
        bound_difference(k, a, {v / axis.velocity_max, -v / axis.velocity_max, 0.0, 0.0});
      if (k > size_ + 1) {  // only jerk reaches as far
      } else {
        if (axis.acceleration_max < unlimited) {
          const double f = acc / axis.acceleration_max;
          bound_difference(k, a, {f, -2.0 * f, f, 0.0});
        }
        if (axis.force_max < unlimited) {
          const double m = axis.mass * acc / axis.force_max, c = axis.damping * v / axis.force_max;
          bound_difference(k, a, {m + c, -2.0 * m - c, m, 0.0});
        }
      }
      if (axis.jerk_max < unlimited) {
        const double f = acc * rate / axis.jerk_max;
        bound_difference(k, a, {f, -3.0 * f, 3.0 * f, -f});
      }
    }
  }

  void add_share() {
    LinearForm form;
    form.constant = -1.0;
    form.add(shift_, 2.0);
    program_.bound(form);
  }

  std::size_t leg_of(std::ptrdiff_t k) const {
    return k < 0 ? w_.leg_before : w_.leg[static_cast<std::size_t>(std::min(k, size_))];
  }
  /// Largest speed of the step to sample k; rapid moves are bounded by their axes.
  double feed(std::ptrdiff_t k) const { return std::max(free_.feed[leg_of(k - 1)], free_.feed[leg_of(k)]); }

  /// Adds a sample to a point.
  void add(LinearPoint& point, int slot, std::ptrdiff_t k, double weight) const {
    if (k >= 0 && k < size_) {
      point.sample[static_cast<std::size_t>(slot)] = static_cast<int>(k) * static_cast<int>(n_);
      point.weight[static_cast<std::size_t>(slot)] = weight;
      return;
    }
    for (std::size_t a = 0; a < n_; ++a) {
      if (k < 0) {
        point.constant[a] += weight * (w_.before[static_cast<std::size_t>(border_ + k) * n_ + a] - origin_[a]);
        continue;
      }
      const std::size_t i = static_cast<std::size_t>(k - size_) * n_ + a;
      point.constant[a] += weight * (w_.after[i] - origin_[a]);
      point.shift[a] += weight * (w_.later[i] - w_.after[i]);
      point.shifted = true;
    }
  }

  void add_steps() {
    const Vector zero{};
    for (std::ptrdiff_t k = 0; k <= size_; ++k) {
      const double speed = feed(k);
      if (!(speed < unlimited)) continue;
      LinearPoint step;
      add(step, 0, k - 1, -1.0);
      add(step, 1, k, 1.0);
      program_.within(step, zero.data(), zero.data(), speed * free_.period * above_feed);
    }
  }

  void add_tube() {
    for (std::ptrdiff_t k = 0; k < size_; ++k) {
      LinearPoint point;
      add(point, 0, k, 1.0);
      add_leg(point, leg_of(k), free_.radius[leg_of(k)]);
    }
  }

  double guess(std::ptrdiff_t k, std::size_t a) const {
    const auto row = [&](const std::vector<double>& rows, std::ptrdiff_t i) {
      return rows[static_cast<std::size_t>(i) * n_ + a];
    };
    return k < 0 ? row(w_.before, border_ + k) : k < size_ ? row(w_.guess, k) : row(w_.after, k - size_);
  }

  void add_pass(const WindowPass& pass) {
    const double floor = std::floor(pass.at);
    const auto k = static_cast<std::ptrdiff_t>(floor);
    const double slack = k < 0 || k + 1 >= size_ ? free_.slack : 0.0;
    LinearPoint point;
    add(point, 0, k, 1.0 - (pass.at - floor));
    add(point, 1, k + 1, pass.at - floor);
    Vector a{}, b{};
    for (std::size_t i = 0; i < n_; ++i) {
      const double slide = w_.slide * pass.room * (guess(k + 1, i) - guess(k, i));
      const double vertex = free_.path.point(pass.joint + 1)[i] - origin_[i];
      a[i] = vertex - slide;
      b[i] = vertex + slide;
    }
    program_.within(point, a.data(), b.data(), (free_.passes_within(pass.joint) + slack) * inside);
    if (!free_.has_contour()) return;
    for (const std::size_t leg : {pass.joint, pass.joint + 1}) add_leg(point, leg, free_.path.contour_max + slack);
  }

  /// A point is within a distance of a block.
  void add_leg(const LinearPoint& point, std::size_t leg, double distance) {
    Vector a{}, b{};
    for (std::size_t i = 0; i < n_; ++i) {
      a[i] = free_.path.point(leg)[i] - origin_[i];
      b[i] = free_.path.point(leg + 1)[i] - origin_[i];
    }
    program_.within(point, a.data(), b.data(), distance * inside);
  }

  const FreePath& free_;
  const Window& w_;
  const std::size_t n_;
  const std::ptrdiff_t border_, size_;
  const int shift_;
  Vector origin_{};
  ConeProgram program_;
};

}  // namespace

bool solve_window(const FreePath& free, Window& window, bool maximise, double& share) {
  WindowProgram program(free, window);
  return program.solve(window.guess, maximise, share);
}

}  // namespace accdec
