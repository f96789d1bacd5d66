#include "program_profiles.hpp"

#include <cstdio>

#include <accdec/files/atomic_file.hpp>
#include <accdec/files/stream_file.hpp>

namespace accdec::cli {

void write_profiles(const ProfileResult& result, const ProfileOutputs& outputs, Context& context) {
  const bool holds = result.message.empty();
  StreamFile samples, stream;
  if (holds && !outputs.samples.empty()) {
    samples.open(outputs.samples);
    write_profile_samples(result, samples.stream());
    samples.close();
  }
  if (holds && !outputs.stream.empty()) {
    stream.open(outputs.stream);
    stream_profile(result, stream.stream());
    stream.close();
  }
  OutputFiles files;
  if (!outputs.json.empty()) files.add(outputs.json, profiles_to_json(result));
  files.commit();
  samples.commit();
  stream.commit();
  const bool stdout_taken = outputs.json == "-" || outputs.samples == "-" || outputs.stream == "-";
  if (!holds) std::fprintf(stderr, "%s\n", result.message.c_str());
  if (!context.quiet && !stdout_taken) std::fputs(profiles_summary(result).c_str(), stdout);
  context.exit_code = holds ? exit_ok : exit_no_answer;
}

}  // namespace accdec::cli
