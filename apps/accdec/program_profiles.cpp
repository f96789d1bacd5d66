#include "program_profiles.hpp"

#include <cstdio>
#include <vector>

#include <accdec/files/output_files.hpp>

namespace accdec::cli {

void write_profiles(const ProfileResult& result, const ProfileOutputs& outputs, Context& context) {
  const bool holds = result.message.empty();
  std::vector<OutputFile> large;
  if (holds && !outputs.samples.empty()) {
    write_profile_samples(result, large.emplace_back(outputs.samples).stream());
    large.back().close();
  }
  if (holds && !outputs.stream.empty()) {
    stream_profile(result, large.emplace_back(outputs.stream).stream());
    large.back().close();
  }
  OutputFiles files;
  if (!outputs.json.empty()) files.add(outputs.json, profiles_to_json(result));
  files.commit();
  for (OutputFile& file : large) file.commit();
  const bool stdout_taken = outputs.json == "-" || outputs.samples == "-" || outputs.stream == "-";
  if (!holds) std::fprintf(stderr, "%s\n", result.message.c_str());
  if (!context.quiet && !stdout_taken) std::fputs(profiles_summary(result).c_str(), stdout);
  context.exit_code = holds ? exit_ok : exit_no_answer;
}

}  // namespace accdec::cli
