#pragma once

#include <optional>

#include <accdec/program.hpp>

namespace accdec {

/// How the motion behind the servo ends, what it leaves out at stops, and how it bends legs. None without a servo.
/// Reads all samples. @param machine  as many axes as the path
std::optional<ServoReport> servo_report(const ProgramResult& result, const Machine& machine);

}  // namespace accdec
