#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <accdec/machine.hpp>

namespace accdec {

/// The least that every way of an axis that goes back and forth adds to the time of all of them.
///
/// A multiplier m weighs the ways against their time: for every m >= 0 the sum of the least h + m (w D/h - g(h)) is a
/// bound. THEORY.md, "Axes that go back and forth", derives it and has g.
class SwingTimes {
 public:
  static constexpr std::size_t kinds_max = 3;  ///< values of m
  SwingTimes(const Machine& machine, std::size_t dimensions);

  /// How many values of m differ. Ways of one chain have the same.
  std::size_t kinds() const { return kinds_; }
  /// s, of a way D > 0 between two turns, or from a turn to rest.
  double inside(std::size_t axis, std::size_t kind, double way) const;
  /// s, of a way with a free end.
  double at_end(std::size_t axis, std::size_t kind, double way) const;

  /// The least h + m (2 D/h - g(h)) of a way. @param jerk  limited
  static double least(double acceleration, double jerk, double multiplier, double way);

 private:
  struct Table {
    double acceleration = 0.0;
    bool jerk = false;
    std::array<std::vector<double>, kinds_max> inside{};  ///< at steps of D
  };
  std::size_t kinds_ = 1;
  std::vector<Table> axes_;
};

}  // namespace accdec
