#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include <accdec/design/verify_today.hpp>
#include <accdec/files.hpp>
#include <accdec/files/output_files.hpp>
#include <accdec/files/shown_text.hpp>
#include <accdec/files/text_file.hpp>
#include <accdec/formats/circle_json.hpp>
#include <accdec/formats/instance_proof_json.hpp>
#include <accdec/plan/record/program_record.hpp>
#include <accdec/result.hpp>
#include <accdec/task/verification_cost.hpp>
#include <accdec/verify.hpp>

#include "command.hpp"
#include "option_checks.hpp"
#include "verify_program.hpp"

namespace accdec::cli {
namespace {

/// About, of the design in a result.
double simulation_seconds(const DesignResult& result) {
  if (!result.filter) return 0.0;
  std::vector<int> delays;
  for (const CornerResult& corner : result.corners) delays.push_back(corner.delay);
  return verification_cost(result.task, result.filter->order(), delays).seconds();
}

/// About, of a result's file, on the same core; 0 of what is no plain file.
double reading_seconds(const std::string& path) {
  std::error_code unknown;
  const auto bytes = std::filesystem::file_size(path, unknown);
  return unknown ? 0.0 : 1e-8 * static_cast<double>(bytes);
}

/// Whether what is left to do would last longer than the time limit; says so.
bool too_long(const std::string& path, std::string_view what, double seconds, double limit, Context& context) {
  if (seconds <= limit) return false;
  context.exit_code = exit_no_answer;
  fmt::print(stderr, "{}: not checked: {} would take about {} s; --time-limit is {:g} s\n", printable(path), what,
             shown_above(seconds, limit), limit);
  return true;
}

void verify_instance_proof(const std::string& text, const std::string& path, double end, Context& context) {
  const auto began = std::chrono::steady_clock::now();
  const CheckReport check =
      check_instance_proof(parse_instance_proof(text, path), [&] { return seconds_since(began) > end; });
  if (!check.accepted) context.exit_code = exit_no_answer;
  if (context.quiet) return;
  fmt::print("{}{}\n", check.accepted ? "proof accepted: " : "rejected\n  ", printable(check.reason));
}

}  // namespace

void add_verify(CLI::App& app, Context& context) {
  auto path = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand("verify", "Recheck a result and its certificate independently");
  command->add_option("result", *path, "Result file of evaluate, design or program, or proof of instances")
      ->required()
      ->type_name("RESULT.json");
  auto limit = std::make_shared<double>(60.0);
  command->add_option("--time-limit", *limit, "Seconds for the check; a result that needs longer is not accepted")
      ->capture_default_str()
      ->check(positive_number());
  command->callback([path, limit, &context] {
    const auto began = std::chrono::steady_clock::now();
    require_outputs({}, {*path});
    if (too_long(*path, "reading it", reading_seconds(*path), *limit, context)) return;
    const std::string text = read_text_file(*path, result_file_limit);
    if (schema_of_program(text)) return verify_program(text, *path, *limit, seconds_since(began), context);
    if (is_instance_proof(text)) return verify_instance_proof(text, *path, *limit - seconds_since(began), context);
    const DesignResult result = parse_result(text, *path);
    const double reading = seconds_since(began);
    if (too_long(*path, reading > 0.5 ? "reading it and simulating the design" : "simulating the design",
                 reading + simulation_seconds(result), *limit, context))
      return;
    const auto end = began + std::chrono::duration<double>(*limit);
    ResultCheck check = verify_result(result, [end] { return std::chrono::steady_clock::now() > end; });
    if (const auto circle = circle_of(text)) {
      for (std::string& reason : check_circle(*circle, result)) check.reasons.push_back(std::move(reason));
      check.accepted = check.reasons.empty();
    }
    if (check.accepted) {
      if (context.quiet) return;
      if (!check.verification.performed) {
        fmt::print("accepted: there is no design\n");
      } else {
        fmt::print("accepted: all limits hold in simulation; worst {}\n",
                   check.verification.worst.empty() ? "none" : check.verification.worst);
      }
      if (!check.proof.empty()) fmt::print("proof accepted: {}\n", check.proof);
      if (result.savings && !knows_delays_of_today(result.task))
        fmt::print("savings.today_s was found again by the search of designs itself, not by a second method\n");
      fmt::print("not checked, because it cannot be recomputed: message, stop, solver, samples of limits{}{}\n",
                 result.savings ? ", the parts of savings" : "",
                 result.free_taps ? ", free_taps_s between its bound and the time of the settings" : "");
      return;
    }
    context.exit_code = exit_no_answer;
    if (context.quiet) return;
    fmt::print("rejected\n");
    for (const std::string& reason : check.reasons) fmt::print("  {}\n", printable(reason));
  });
}

}  // namespace accdec::cli
