#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace accdec {

/// A damped vibration: frequency in Hz without damping, and damping ratio.
struct Decay {
  double frequency, damping;
};

/// Relative standard errors of a vibration that was fitted.
struct DecayError {
  double frequency, damping;
  double colour;  ///< variance of what is left near the frequency, over that of all that is left; 1: white
};

/// The limits of a search for modes.
struct DecaySearch {
  double frequency_min, frequency_max;  ///< Hz
  double damping_max;
  std::size_t most;  ///< modes
};

/// Samples from `begin` to before `end`.
struct Stretch {
  std::size_t begin, end;
};

/// A constant, and for every pole the damped cosine and sine.
Eigen::MatrixXd decaying_waves(const std::vector<Decay>& poles, Eigen::Index rows, double period);

/// Fits stretches of a signal by sums of damped vibrations. All stretches share frequencies and damping ratios; each
/// has its own amplitudes, which are eliminated (variable projection: Golub, Pereyra, SIAM J. Numer. Anal. 10, 1973).
class DecayFit {
 public:
  DecayFit(const std::vector<double>& signal, std::vector<Stretch> stretches, double period);

  std::size_t samples() const { return samples_; }
  std::size_t stretches() const { return stretches_.size(); }
  const std::vector<Stretch>& all() const { return stretches_; }
  std::vector<std::vector<double>> in_stretches(const Eigen::VectorXd& all) const;

  /// The signal without the vibrations. @param parts  the energy of each vibration's part, if asked for
  Eigen::VectorXd rest(const std::vector<Decay>& poles, std::vector<double>* parts = nullptr) const;

  /// Gauss-Newton with Levenberg's damping in the logarithms of frequencies and damping ratios.
  /// @return the energy that is left
  double improve(std::vector<Decay>& poles, const DecaySearch& search) const;

  /// Standard errors by the slopes of the fit and the variance of what is left near each frequency.
  std::vector<DecayError> errors(const std::vector<Decay>& poles, const DecaySearch& search) const;

 private:
  Eigen::MatrixXd slopes(const std::vector<Decay>& poles, const Eigen::VectorXd& now, const DecaySearch& search) const;

  const std::vector<double>& signal_;
  std::vector<Stretch> stretches_;
  double period_;
  std::size_t samples_ = 0;
};

}  // namespace accdec
