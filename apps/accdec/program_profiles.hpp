#pragma once

#include <string>

#include <accdec/program/profiles/profile_result.hpp>

#include "command.hpp"

namespace accdec::cli {

/// Where `accdec program --plan profiles` writes; empty: nowhere, -: standard output.
struct ProfileOutputs {
  std::string json, samples, stream;
};

/// Writes the files and the summary of a plan. A plan that breaks a limit leaves no samples: only its JSON and its
/// message.
void write_profiles(const ProfileResult& result, const ProfileOutputs& outputs, Context& context);

}  // namespace accdec::cli
