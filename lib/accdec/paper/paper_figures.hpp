#pragma once

#include <string>
#include <vector>

#include <accdec/filter.hpp>
#include <accdec/paper/paper_case.hpp>

namespace accdec::paper {

/// One named column of numbers; the unit is part of the name ("v_a_mm_s").
struct Column {
  std::string name;
  std::vector<double> values;
};
/// The numbers behind one figure, as its CSV file holds them: columns of equal length.
struct FigureData {
  int number = 0;  ///< of the paper's figure, 1 .. 12
  std::vector<Column> columns;
  /// @throws std::out_of_range if there is none of that name.
  const std::vector<double>& operator[](const std::string& name) const;
};

/// Fig. 1: the command at each station of the layout: interpolator, Acc/Dec processor, servo; one leg along x.
FigureData figure1();
/// Fig. 2: a leg from A to B, velocity and way before and after linear Acc/Dec.
FigureData figure2();
/// Fig. 3: the blended mode from A through B to C, velocities of both legs before and after linear Acc/Dec.
FigureData figure3();
/// Fig. 4: the path of Fig. 3's motion around the corner, in the x-y frame and in the a-b frame, mm.
FigureData figure4();
/// Fig. 5: the whole motion in the a-b frame, from rest to rest, linear Acc/Dec, v1 = v2. Time 0 is the corner command.
FigureData figure5();
/// Fig. 6: speed around the corner without delay and with dT = 10 T.
FigureData figure6();
/// Fig. 7, 8 and 10: components of both legs and their sums along a and b around the corner. They are linear without
/// delay, linear with dT = 10 T, and FIR without and with dT = 10 T.
FigureData figure7();
FigureData figure8();
FigureData figure10();
/// Fig. 9: exact corner error of linear Acc/Dec over dT, for several c, v1 = 4e5 BLU/s.
FigureData figure9();
/// Fig. 11: E = eps/v0 of FIR Acc/Dec, N = 40, over dT and c: long form, one line per (dT, c).
FigureData figure11();
/// Fig. 12: paths of the three Acc/Dec processors at v1 = 100 mm/s, c = 2, in the a-b frame, mm.
FigureData figure12_paths();
/// Corner errors of the three processors of Fig. 12 over the delay, um.
FigureData figure12_errors();

inline constexpr double figure_feed =
    0.4;                                 ///< v1 of Fig. 5-10, m/s: 4e5 BLU/s; printed for Fig. 9, taken for the others
inline constexpr int figure_delay = 10;  ///< dT/T of Fig. 6, 8 and 10; the paper prints none
inline constexpr double figure12_feed = 0.1;  ///< m/s: the printed 6000 mm/sec must be mm/min
inline constexpr double figure12_ratio = 2.0;

/// The Acc/Dec processors of Fig. 12: linear in continuous time, sampled (as in Table 1), quintic S-curve, Blackman
/// FIR.
enum class Processor { linear, s_curve, fir };
/// Corner error at samples with a delay of `delay` samples, m. @param theta  interior angle, rad
double figure12_error(Processor processor, int delay, double theta = angle);
/// Smallest delay, samples, with which a processor is as accurate as the FIR without delay.
int figure12_delay(Processor processor, double theta = angle);

/// A comparison of two filters at equal limits instead of equal order.
struct EqualLimits {
  double tap_max = 0.0;       ///< largest tap of the FIR: peak acceleration over v/T
  double step_max = 0.0;      ///< largest difference of neighbouring taps, both ends included: peak jerk over v/T^2
  int least_order = 0;        ///< no filter within both has a smaller order
  double least_sum = 0.0;     ///< sum of min(tap_max, (i+1) step_max, (N+1-i) step_max) at that order, >= 1
  double envelope_mad = 0.0;  ///< mean absolute deviation of those taps divided by their sum, samples
  int trapezoid_order = 0, trapezoid_ramp = 0;  ///< the shortest of `trapezoid(order, ramp)` within both
  double trapezoid_mad = 0.0;                   ///< samples
  double fir_mad = 0.0;                         ///< samples
  int boxcar_order = 0;                         ///< the shortest boxcar with no larger tap (jerk not limited)
  double boxcar_mad = 0.0;                      ///< samples
};
/// Checks "the FIR has the smallest corner error" at equal acceleration and jerk instead of equal order. With equal
/// feeds and a symmetric filter, eps = v0 T cos(theta/2) MAD (Eq. 24). So the MAD ranks the errors at every corner.
EqualLimits equal_limits();

/// sum_i b_i |i - M|, samples.
double mean_absolute_deviation(const Filter& filter);

}  // namespace accdec::paper
