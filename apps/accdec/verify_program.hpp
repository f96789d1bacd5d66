#pragma once

#include <string>

#include "command.hpp"

namespace accdec::cli {

/// `accdec verify` of a result of `accdec program`: its commands simulated anew, and held against the program's file
/// where that is still there as it was.
/// @param limit  s; what is estimated to take longer is not begun
void verify_program(const std::string& text, const std::string& path, double limit, Context& context);

/// Says why a result of --plan profiles is not accepted.
void refuse_profiles(Context& context);

}  // namespace accdec::cli
