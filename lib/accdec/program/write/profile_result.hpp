#pragma once

#include <cstdint>
#include <optional>
#include <ostream>
#include <string>

#include <accdec/program/plan/corner_bound.hpp>
#include <accdec/program/plan/plan_time.hpp>
#include <accdec/program/profiles/plan_profiles.hpp>
#include <accdec/program/read/toolpath.hpp>
#include <accdec/program/write/samples.hpp>
#include <accdec/task/task.hpp>

namespace accdec {

/// What `accdec program --plan profiles` answers; `accdec.profiles/1` in JSON.
struct ProfileResult {
  std::string program;  ///< the file
  Toolpath path;
  double sample_period = 0.0;  ///< s
  ProfilePlan plan;
  double cycle_time = 0.0;                            ///< s, samples times T, to the first at rest
  double lower_bound = 0.0;                           ///< s, see program_lower_bound; by whoever asks for it
  std::optional<CornerBound> corner_bound;            ///< the same
  std::size_t corners = 0;                            ///< joints that turn or stop
  std::size_t stops = 0;                              ///< of these at rest
  double worst_error = 0.0, worst_utilisation = 0.0;  ///< m, of joints with a tolerance; share of it
  std::uint32_t worst_line = 0;
  double wall_time = 0.0;            ///< s
  std::vector<PlanTime> candidates;  ///< plans that were made beside this one
  std::string message;               ///< why the plan is no result; empty if it is one
};

/// Plans and verifies a program, see plan_profiles.
/// @throws std::invalid_argument for what the plan cannot take: vibration bounds that no last filter holds, delays that
/// the program brings along
ProfileResult run_profiles(const std::string& name, Toolpath path, const Task& task);

/// The table for people.
std::string profiles_summary(const ProfileResult& result);
/// Ends with a line feed.
std::string profiles_to_json(const ProfileResult& result);
/// Every sample, the start included.
void visit_profile_samples(const ProfileResult& result, const SampleVisitor& visit);
/// time_s and position and velocity of every axis in its own unit, as write_samples writes them for the other plans.
/// Only of a plan that holds.
void write_profile_samples(const ProfileResult& result, std::ostream& out);
/// For a controller that takes positions, see stream_row.
void stream_profile(const ProfileResult& result, std::ostream& out);

}  // namespace accdec
