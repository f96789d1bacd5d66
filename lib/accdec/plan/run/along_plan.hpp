#pragma once

#include <optional>

#include <accdec/plan/free/free_path.hpp>
#include <accdec/program.hpp>

namespace accdec {

/// Samples with their passes as a motion.
FreeMotion as_motion(const Toolpath& path, const FreeSamples& samples);

/// A result with the samples of a plan, before it is judged. Bounds and counts of the program stay.
ProgramResult with_samples(const ProgramResult& plan, const FreeSamples& samples);

/// Whether a program rests for so long that a motion given by its samples would be nothing but rest.
bool rests_too_long(const Toolpath& path, double sample_period);

/// A plan and its samples.
struct AlongPlan {
  ProgramResult result;
  FreeSamples samples;
};

/// Plan profiles with its runs along arcs planned along the path, axis by axis (see along_run), where that is faster.
/// @returns none where nothing is gained, or the check of all samples refuses it
std::optional<AlongPlan> plan_along(const ProgramResult& profiles, const Task& task, const Deadline& deadline);

}  // namespace accdec
