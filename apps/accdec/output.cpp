#include "output.hpp"

#include <cstdio>

#include <accdec/files/output_files.hpp>
#include <accdec/formats/report.hpp>
#include <accdec/formats/result_json.hpp>

namespace accdec::cli {

int deliver(const DesignResult& result, const std::string& json_path, const Context& context) {
  if (!json_path.empty()) write_file(json_path, result_to_json(result));
  if (json_path != "-" && !context.quiet) print_result(result);
  const bool answered = result.status == Status::optimal || result.status == Status::feasible;
  // Whoever asked for no table still has to learn why there is no answer.
  if (!answered && (context.quiet || json_path == "-")) {
    std::fprintf(stderr, "%s: %s\n", std::string(to_string(result.status)).c_str(), result.message.c_str());
  }
  return answered ? exit_ok : exit_no_answer;
}

}  // namespace accdec::cli
