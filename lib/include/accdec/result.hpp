// Results of designs, and how they are written, read, printed and exported.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <accdec/files.hpp>
#include <accdec/machine.hpp>
#include <accdec/problem.hpp>
#include <accdec/task.hpp>

namespace accdec {

struct Certificate;  // certificate.hpp

enum class Status {
  optimal,     ///< verified, and proved that nothing is shorter
  feasible,    ///< verified
  infeasible,  ///< no filter and delays within the task's bounds hold all limits
  failed       ///< no verified answer; the message gives the reason
};
std::string_view to_string(Status status);

/// Why a design ended. Except after `finished`, more time might have given a better result.
enum class StopReason {
  finished,     ///< the method had nothing more to try
  gap_reached,  ///< the gap asked for
  time_limit,
  interrupted  ///< from outside
};
inline constexpr StopReason stop_reasons[] = {StopReason::finished, StopReason::gap_reached, StopReason::time_limit,
                                              StopReason::interrupted};
std::string_view to_string(StopReason reason);

struct CornerResult {
  std::string name;
  int delay = 0;                                                             ///< samples
  double corner_error = 0.0, polyline_error = 0.0, contour_deviation = 0.0;  ///< m, see CornerMeasures
  double speed_min = 0.0;                                                    ///< m/s
  double corner_time = 0.0;                                                  ///< s
  /// s; how long after the end of the filtered command the motion still is farther from its end than the tolerance.
  double settling_time = 0.0;
  double feed_part = 1.0;  ///< of both feeds, at which the corner is passed; below 1 with DelayKind::corner_feed
};

/// Result of the independent simulation.
struct VerificationReport {
  bool performed = false;
  bool feasible = false;
  double max_violation = 0.0;  ///< largest utilisation above 1, minus 1; 0 when feasible to the last bit
  double tolerance = 0.0;      ///< relative violation up to which `feasible` holds
  std::string worst;           ///< the limit in words: "force x: 97.1 % at k = 12 of the stop, corner A"
  bool certificate_checked = false;
  std::string certificate;  ///< the checker's answer about the lower bound
};

struct SolverReport {
  std::string method;  ///< "given", "exact", "nlp"
  std::string name;    ///< "ipopt", "clp", ...; empty when nothing was solved
  std::string version;
  std::string claimed;
  long evaluations = 0;
  double wall_time = 0.0;  ///< s
  nlp::Counts counts;      ///< of all single solves together; zero if the method has none
};

/// Savings of a design against the filter that the machine has today, by steps, in s of what the task minimises. The
/// steps add up to the total.
struct Savings {
  double today = 0.0;  ///< time with today's filter and its smallest delays
  double total = 0.0;  ///< today less the design's
  std::optional<double>
      by_retuning;                  ///< the best of today's own family; none: of no family, or not searched to the end
  std::optional<double> by_family;  ///< from there, or from today, to the best of all families; none: not searched
  std::optional<double> by_taps;    ///< from there to the design
  std::string family;               ///< the best of all, "trapezoid-zv"
  bool complete = false;  ///< every family was searched to the end; if not, by_family is a least and by_taps a most
};

/// A design whose taps are whole numbers over 2^bits.
struct Quantisation {
  int bits = 0;
  std::vector<std::int64_t> coefficients;  ///< N + 1 of them, >= 0, of sum 2^bits
  double unquantised = 0.0;                ///< s, of what the task minimises: the best design known of free taps
};

/// The answer to a task; `accdec.result/1` in JSON. A result that is neither optimal nor feasible carries no filter,
/// except one made by `evaluate`, which reports a given filter whatever it breaks.
struct DesignResult {
  Task task;
  Status status = Status::failed;
  StopReason stop = StopReason::finished;
  std::optional<Filter> filter;
  std::vector<CornerResult> corners;
  double cycle_time = 0.0;                 ///< s, machine time: Objective::cycle
  double corner_time = 0.0;                ///< s, each corner by itself: Objective::corner
  std::optional<double> lower_bound;       ///< s, proved, of objective()
  std::optional<double> gap;               ///< (objective() - lower_bound)/objective()
  std::optional<ChosenSettings> settings;  ///< of a task that asks for settings of a controller
  std::optional<double> family_bound;      ///< s, proved, of objective() within the task's families
  std::optional<double> free_taps;         ///< s, objective of the best design known of free taps with any delays
  std::vector<LimitUse> limits;
  VerificationReport verification;
  SolverReport solver;
  std::string message;
  std::optional<Quantisation> quantisation;        ///< of a task that asks for whole coefficients
  std::optional<Savings> savings;                  ///< of a task that names today's filter
  std::shared_ptr<const Certificate> certificate;  ///< null when there is none

  /// Whether it holds a filter and delays that were verified.
  bool has_design() const { return status == Status::optimal || status == Status::feasible; }
  /// s; the one of the two times that the task minimises.
  double objective() const { return task.design.objective == Objective::cycle ? cycle_time : corner_time; }
};

/// A result as `accdec.result/1`: SI units in the keys. Doubles have enough digits to read them back exactly. `task` is
/// written as understood, so that the result is complete by itself. Values that are infinite or missing (an infinite
/// utilisation, no proved bound, no filter) are null. Ends with a line feed.
std::string result_to_json(const DesignResult& result);
/// Bytes of its certificate; 0 without one.
std::size_t proof_size(const DesignResult& result);

/// Reads a result strictly. Errors are: unknown and missing members, wrong types, another schema, numbers that are not
/// finite, corners that do not match the task. Nothing is recomputed; `accdec verify` does that.
/// @throws InputError at the position of the offending value, with its path in the message.
DesignResult parse_result(std::string_view text, const std::string& name);
DesignResult read_result(const std::string& path);

/// A result for people, in um, mm/s, ms and %: status, filter and cycle time. It has one line per corner, and one line
/// for the worst use of every limit over all corners. The result file has everything else.
std::string result_text(const DesignResult& result);

/// Prints this text on standard output.
void print_result(const DesignResult& result);

/// Formats of `export_taps`.
inline constexpr std::string_view taps_formats[] = {"csv",           "c",       "json", "npy", "cascade", "m", "st",
                                                    "linuxcnc-comp", "klipper", "q15",  "q31"};

/// A design for a controller or another tool, as the bytes of a file. Every format holds the taps or settings, the
/// delays of the corners, the title, the limits, and the commit of the accdec that wrote it:
///   csv      a header line and "i,b_i" lines; all else in lines that begin with #
///   c        a header with the order, the sample period, arrays of taps and delays
///   json     all as members
///   npy      three NumPy arrays, one after another: N + 1 taps, the delays, and a JSON text with all else
///   cascade  JSON with the lengths of moving averages whose cascade is this filter
///   m        a script for MATLAB and Octave that makes a struct `accdec`
///   st       a function block in IEC 61131-3 Structured Text
///   linuxcnc-comp  a HAL component for LinuxCNC's halcompile
///   klipper  the section [input_shaper] of a printer.cfg, for taps that are one of Klipper's shapers
///   q15, q31 a header in C with taps in whole numbers over 2^15 or 2^31; what `coefficient_bits` has not made whole is
///            rounded here so that all limits hold, and the header says so
/// Titles and names may hold any characters.
/// @throws std::invalid_argument for an unknown format, a result without a filter, or taps that the format cannot say.
std::string export_taps(const DesignResult& result, std::string_view format);

/// Lengths (>= 2, descending) of moving averages whose convolution is the filter, to within `tolerance` of its largest
/// tap. Empty if there are none. Zero taps at the ends are allowed. A single tap gives {} too. At most three averages
/// are tried.
std::vector<int> moving_average_cascade(const Filter& filter, double tolerance = 1e-9);

}  // namespace accdec
