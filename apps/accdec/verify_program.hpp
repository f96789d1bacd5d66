#pragma once

#include <string>

#include "command.hpp"

namespace accdec::cli {

/// `accdec verify` of a result of `accdec program`: its commands simulated anew, and held against the program's file
/// where that is still there as it was.
/// @param limit  s; what is estimated to take longer is not begun
void verify_program(const std::string& text, const std::string& path, double limit, Context& context);

/// Of a result of --plan profiles: the program planned anew, every sample of it checked, and what is recorded held
/// against that.
void verify_profiles(const std::string& text, const std::string& path, double limit, Context& context);

}  // namespace accdec::cli
