#pragma once

#include <map>
#include <vector>

#include <Eigen/Core>

#include <accdec/filter.hpp>

// Internal to the room: samples of a log, as many values as a filter's fits need.

namespace accdec {

/// Samples between which a filter bends the motion of a leg, both excluded.
struct BentPart {
  int after = 0, before = 0;
};

/// Positions in the samples of a log, and motions of legs in them. Outside the bent parts all motions are straight
/// lines in time. There, two values stand for all samples of a line: these have the same sums of squares and of
/// products of any two lines, and of positions and lines. Keeps references.
class ComparedSamples {
 public:
  /// @param rows  the samples, in rising order
  /// @param at  positions in them, m; axes by columns
  ComparedSamples(const Filter& filter, const std::vector<int>& rows, const Eigen::MatrixXd& at,
                  std::vector<BentPart> bent);

  /// Full-speed samples that a leg has moved that begins `first` samples after the log.
  const Eigen::VectorXd& from(int first);
  /// The values of an axis whose positions are all 1.
  const Eigen::VectorXd& ones() const { return ones_; }
  /// m, axes by columns.
  const Eigen::MatrixXd& at() const { return at_; }
  /// m^2 by axis: differences of positions and the nearest lines.
  const Eigen::VectorXd& beside_lines() const { return beside_lines_; }

 private:
  struct Part {
    std::size_t first = 0, end = 0;  // among the rows
    bool straight = false;
    double middle = 0.0, spread = 0.0;  // mean of the samples; root of the sum of the squared distances from it
  };
  void split(std::vector<BentPart> bent);
  void add(std::size_t first, std::size_t end, bool straight);
  void take(const Eigen::MatrixXd& at);

  const Filter& filter_;
  const std::vector<int>& rows_;
  std::vector<Part> parts_;
  Eigen::Index values_ = 0;
  Eigen::MatrixXd at_;
  Eigen::VectorXd ones_, beside_lines_;
  std::map<int, Eigen::VectorXd> columns_;
};

}  // namespace accdec
