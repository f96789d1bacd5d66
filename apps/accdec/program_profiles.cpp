#include "program_profiles.hpp"

#include <cstdio>

#include <accdec/files/output_files.hpp>
#include <accdec/program/write/samples.hpp>

#include "program_figure.hpp"

namespace accdec::cli {
namespace {

/// Writes the files and the summary of a plan. A plan that breaks a limit leaves no samples: only its JSON and its
/// message.
template <class Samples, class Stream, class Figure>
void write(const ProfileOutputs& outputs, Context& context, const std::string& json, const std::string& summary,
           const std::string& broken, const Samples& samples, const Stream& stream, const Figure& figure) {
  const bool holds = broken.empty();
  std::vector<OutputFile> large;
  if (holds && !outputs.samples.empty()) {
    samples(large.emplace_back(outputs.samples).stream());
    large.back().close();
  }
  if (holds && !outputs.stream.empty()) {
    stream(large.emplace_back(outputs.stream).stream());
    large.back().close();
  }
  OutputFiles files;
  if (!outputs.json.empty()) files.add(outputs.json, json);
  if (holds && !outputs.figure.empty()) files.add(outputs.figure, figure(figure_format(outputs.figure)));
  files.commit();
  for (OutputFile& file : large) file.commit();
  const bool stdout_taken = outputs.json == "-" || outputs.samples == "-" || outputs.stream == "-";
  if (!holds) std::fprintf(stderr, "%s\n", broken.c_str());
  if (!context.quiet && !stdout_taken) std::fputs(summary.c_str(), stdout);
  context.exit_code = holds ? exit_ok : exit_no_answer;
}

}  // namespace

void write_fastest(const std::variant<ProfileResult, ProgramResult>& fastest, const ProgramInputs& inputs,
                   const Toolpath& programmed, const Machine& machine, const ProfileOutputs& outputs,
                   Context& context) {
  if (const auto* profiles = std::get_if<ProfileResult>(&fastest)) {
    write(
        outputs, context, outputs.json.empty() ? "" : profiles_to_json(*profiles, inputs), profiles_summary(*profiles),
        profiles->message, [&](std::ostream& out) { write_profile_samples(*profiles, out); },
        [&](std::ostream& out) { stream_profile(*profiles, out); },
        [&](const std::string& type) { return program_figure(*profiles, programmed, machine, type); });
    return;
  }
  const ProgramResult& other = std::get<ProgramResult>(fastest);
  write(
      outputs, context, outputs.json.empty() ? "" : program_to_json(other, inputs), program_summary(other), {},
      [&](std::ostream& out) { write_samples(other, out); }, [&](std::ostream& out) { stream_samples(other, out); },
      [&](const std::string& type) { return program_figure(other, programmed, machine, type); });
}

}  // namespace accdec::cli
