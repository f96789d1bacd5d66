#include "program_profiles.hpp"

#include <cstdio>

#include <fmt/format.h>

#include <accdec/files/output_files.hpp>
#include <accdec/plot/program_page.hpp>
#include <accdec/program/write/samples.hpp>

namespace accdec::cli {
namespace {

/// Writes the files and the summary of a plan. A plan that breaks a limit leaves no samples: only its JSON and its
/// message.
template <class Samples, class Stream, class Page>
void write(const ProfileOutputs& outputs, Context& context, const std::string& json, const std::string& summary,
           const std::string& broken, const Samples& samples, const Stream& stream, const Page& page) {
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
  if (holds && !outputs.page.empty()) files.add(outputs.page, page());
  files.commit();
  for (OutputFile& file : large) file.commit();
  const bool stdout_taken = outputs.json == "-" || outputs.samples == "-" || outputs.stream == "-";
  if (!holds) std::fprintf(stderr, "%s\n", broken.c_str());
  if (!context.quiet && !stdout_taken) std::fputs(summary.c_str(), stdout);
  context.exit_code = holds ? exit_ok : exit_no_answer;
}

}  // namespace

void write_fastest(ProfileResult profiles, std::vector<ProgramResult> others, const ProgramInputs& inputs,
                   const Toolpath& programmed, const Machine& machine, const ProfileOutputs& outputs,
                   Context& context) {
  const auto page_of = [&](const std::string& name, double time, const auto& samples) {
    return program_page(
        programmed, program_machine(machine, programmed),
        {fmt::format("{}: {:.6g} s, plan {}", profiles.program, time, name), profiles.sample_period, samples});
  };
  const PlanTime mine{"profiles", profiles.cycle_time, profiles.message.empty()};
  const ProgramResult* best = nullptr;
  for (const ProgramResult& other : others) {
    profiles.candidates.push_back(
        {other.legs.single() ? "fixed" : "per-leg", other.cycle_time, other.verification.feasible});
    if (!other.verification.feasible) continue;
    const double shortest = best != nullptr ? best->cycle_time : mine.time;
    if (other.cycle_time < shortest || (best == nullptr && !mine.verified)) best = &other;
  }
  if (best == nullptr) {
    write(
        outputs, context, profiles_to_json(profiles), profiles_summary(profiles), profiles.message,
        [&](std::ostream& out) { write_profile_samples(profiles, out); },
        [&](std::ostream& out) { stream_profile(profiles, out); },
        [&] {
          return page_of("profiles", profiles.cycle_time,
                         [&](const SampleVisitor& visit) { visit_profile_samples(profiles, visit); });
        });
    return;
  }
  ProgramResult fastest = *best;
  fastest.candidates = profiles.candidates;
  fastest.candidates.push_back(mine);
  write(
      outputs, context, program_to_json(fastest, inputs), program_summary(fastest), {},
      [&](std::ostream& out) { write_samples(fastest, out); }, [&](std::ostream& out) { stream_samples(fastest, out); },
      [&] {
        return page_of(fastest.legs.single() ? "fixed" : "per-leg", fastest.cycle_time,
                       [&](const SampleVisitor& visit) { visit_samples(fastest, visit); });
      });
}

}  // namespace accdec::cli
