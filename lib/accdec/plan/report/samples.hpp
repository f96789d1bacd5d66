#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json_fwd.hpp>

#include <accdec/bounds/corner_bound.hpp>
#include <accdec/program.hpp>
#include <accdec/simulate.hpp>

namespace accdec {

struct ProgramResult;

/// A motion as a table, written as it is made: time_s and position and velocity of every axis in its own unit (x_mm,
/// x_mm_s, .. or a_deg, a_deg_s, ..). A control with a position unit gets whole numbers of it instead (x_units, ..):
/// every position is rounded by itself, so that nothing adds up.
class SampleTable {
 public:
  /// References are kept. Writes the header.
  /// @param servo  whether there is a motion behind the command: x_motion_mm, x_motion_mm_s, ..
  /// @param unit  m, see Machine::position_unit
  SampleTable(const Toolpath& path, double sample_period, std::ostream& out, bool servo = false, double unit = 0.0);
  ~SampleTable() { flush(); }
  SampleTable(const SampleTable&) = delete;
  SampleTable& operator=(const SampleTable&) = delete;
  /// Sample k: positions in m, velocities in m/s, one per dimension of the path.
  /// @param motion  behind the servo; nullptr: none
  void row(std::int64_t k, const double* position, const double* velocity, const Sample* motion = nullptr);

 private:
  void flush();
  void put(const double* position, const double* velocity);
  const Toolpath& path_;
  double period_, unit_;
  std::ostream& out_;
  fmt::memory_buffer text_;
};

/// Takes sample k: positions in m, velocities in m/s, one per dimension of the path.
using SampleVisitor = std::function<void(std::int64_t k, const double* position, const double* velocity)>;
/// Which samples are visited: all, or of long rests and of steady motion only the beginning and the end. There the
/// numbers of the samples jump, and the motion goes straight on at one speed from one to the next.
enum class Steady { whole, passed };
/// The command, which controllers are sent, or what the servo of the axes makes of it.
enum class MotionOf { command, servo };
/// Every sample from the start, which is sample 0, to the first at rest.
void visit_samples(const ProgramResult& result, const SampleVisitor& visit, Steady steady = Steady::whole,
                   MotionOf of = MotionOf::command);

/// From the first sample to the first at rest of the command, with the motion behind a servo.
void write_samples(const ProgramResult& result, std::ostream& out);

/// For a controller that takes positions: one line per cycle, separated by blanks; flushed. It has the position of
/// every axis in its own unit with nine decimals, or as whole numbers of the control's unit. The first line of a stream
/// is the start.
/// @param unit  m, see Machine::position_unit
void stream_row(const Toolpath& path, const double* position, std::ostream& out, double unit = 0.0);
/// Writes the whole motion in this form.
void stream_samples(const ProgramResult& result, std::ostream& out);

/// "plan fixed" or "plan fixed, not verified": a row of a summary.
std::string describe(const PlanTime& plan);
/// A bound of a program's time and which motions it holds for.
struct NamedBound {
  std::string name;      ///< "any motion"
  double time = 0.0;     ///< s
  std::string motions;   ///< a sentence; behind a ";" what else is to be said
  bool complete = true;  ///< false where time or linear programs ran out: a finished bound may be larger
};
/// All that are known, the widest class of motions first. @param lower_bound  s, see program_lower_bound
std::vector<NamedBound> named_bounds(double lower_bound, const std::optional<CornerBound>& corner_bound);
/// Those of a plan; none where none was computed.
std::vector<NamedBound> bounds_of(const ProgramResult& result);
nlohmann::ordered_json bounds_to_json(const std::vector<NamedBound>& bounds);
/// "12 of 30 corners ..": below the bound's row in a summary.
std::string describe(const CornerBound& bound);
nlohmann::ordered_json corner_bound_to_json(const CornerBound& bound);
/// A list of plan, cycle_time_s, verified.
nlohmann::ordered_json plan_times_to_json(const std::vector<PlanTime>& plans);

}  // namespace accdec
