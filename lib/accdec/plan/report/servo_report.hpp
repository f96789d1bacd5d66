#pragma once

#include <optional>

#include <accdec/program.hpp>

namespace accdec {

/// How the motion behind the servo ends, and what it leaves out at stops. None without a servo. Reads all samples.
std::optional<ServoReport> servo_report(const ProgramResult& result);

}  // namespace accdec
