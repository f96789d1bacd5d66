#include <chrono>
#include <memory>
#include <string>

#include <fmt/format.h>

#include <accdec/design/recheck.hpp>
#include <accdec/formats/result_json.hpp>

#include "command.hpp"

namespace accdec::cli {

void add_verify(CLI::App& app, Context& context) {
  auto path = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand("verify", "Independent recheck of a result and of its certificate");
  command->add_option("result", *path, "Result file of evaluate or design")->required()->type_name("RESULT.json");
  auto limit = std::make_shared<double>(60.0);
  command->add_option("--time-limit", *limit, "Seconds for checking a proof; one that takes longer is rejected")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  command->callback([path, limit, &context] {
    const DesignResult result = read_result(*path);
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(*limit);
    const Recheck check = recheck(result, [end] { return std::chrono::steady_clock::now() > end; });
    if (check.accepted) {
      if (context.quiet) return;
      if (!check.verification.performed) {
        fmt::print("accepted: there is no design\n");
      } else {
        fmt::print("accepted: all limits hold in simulation; worst {}\n",
                   check.verification.worst.empty() ? "none" : check.verification.worst);
      }
      if (!check.proof.empty()) fmt::print("proof accepted: {}\n", check.proof);
      return;
    }
    context.exit_code = exit_no_answer;
    if (context.quiet) return;
    fmt::print("rejected\n");
    for (const std::string& reason : check.reasons) fmt::print("  {}\n", reason);
  });
}

}  // namespace accdec::cli
