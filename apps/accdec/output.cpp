#include "output.hpp"

#include <cmath>
#include <cstdio>

#include <fmt/format.h>

#include <accdec/files/output_files.hpp>
#include <accdec/files/shown_text.hpp>
#include <accdec/result.hpp>

#include "terminal.hpp"

namespace accdec::cli {

std::optional<double> fraction(const std::string& text) {
  std::string number = text;
  const bool percent = !number.empty() && number.back() == '%';
  if (percent) number.pop_back();
  while (!number.empty() && number.back() == ' ') number.pop_back();
  double value = 0.0;
  if (!CLI::detail::lexical_cast(number, value)) return std::nullopt;
  if (percent) value /= 100.0;
  if (!(value >= 0.0 && value < 1.0)) return std::nullopt;
  return value;
}

namespace {

bool claims_proof(const DesignResult& result) {
  return result.certificate || result.status == Status::optimal || result.lower_bound || result.gap;
}

/// A file without a proof must not contain claims that nobody can recheck.
DesignResult without_proof(DesignResult result) {
  result.certificate.reset();
  if (result.status == Status::optimal) {
    result.status = Status::feasible;
    result.message = "proved shortest when it was designed; the proof is not in this file";
  }
  result.lower_bound.reset();
  result.family_bound.reset();
  result.gap.reset();
  return result;
}

}  // namespace

void warn(const Task& task, const std::string& path, const Context& context) {
  for (const std::string& note : task.notes) {
    if (!context.quiet) fmt::print(stderr, "accdec: note: {}: {}\n", printable(path), note);
  }
  constexpr double shortest = 0.05, longest = 20.0;  // ms, of controllers
  const double period = 1e3 * task.sample_period;
  if (context.quiet || (period >= shortest * (1.0 - 1e-9) && period <= longest * (1.0 + 1e-9))) return;
  fmt::print(stderr,
             "accdec: warning: {}: sample_period_ms = {:g} is outside {:g} to {:g}, the periods of controllers\n",
             printable(path), period, shortest, longest);
}

int deliver(const DesignResult& result, const std::string& json_path, const Context& context, double certificate_max,
            const std::optional<CircleRecord>& circle) {
  if (!json_path.empty()) {
    const double megabytes = result.certificate ? 1e-6 * static_cast<double>(proof_size(result)) : 0.0;
    const bool keep = result.certificate && megabytes <= certificate_max;
    if (result.certificate && !keep) {
      std::fprintf(stderr, "%s: the proof, %.3g MB, was left out; --certificate-max %.0f keeps it\n",
                   printable(json_path).c_str(), megabytes, std::ceil(megabytes));
    }
    // With very many corners, copying costs as much as writing the text.
    const bool as_it_is = keep || !claims_proof(result);
    std::string json = result_to_json(as_it_is ? result : without_proof(result));
    if (circle) add_circle(json, *circle);
    write_file(json_path, json);
  }
  if (json_path != "-" && !context.quiet) {
    const std::string text = result_text(result);
    std::fputs((is_coloured(stdout) ? with_coloured_status(text) : text).c_str(), stdout);
  }
  const bool answered = result.status == Status::optimal || result.status == Status::feasible;
  // Whoever asked for no table still has to learn why there is no answer.
  if (!answered && (context.quiet || json_path == "-")) {
    fmt::print(stderr, "{}: {}\n", to_string(result.status), printable(result.message));
  }
  return answered ? exit_ok : exit_no_answer;
}

}  // namespace accdec::cli
