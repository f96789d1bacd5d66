#pragma once

#include <optional>
#include <string>

#include <accdec/machine.hpp>
#include <accdec/program.hpp>

namespace accdec {

/// How far servos that differ bend the legs of a plan. None where they do not, and where no leg is long enough. Reads
/// all samples. @param machine  as many axes as the path
std::optional<LegError> leg_error(const ProgramResult& result, const Machine& machine);

/// The same in words; empty if servos do not differ.
std::string leg_error_text(const ProgramResult& result);

}  // namespace accdec
