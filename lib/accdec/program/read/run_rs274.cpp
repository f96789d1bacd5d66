#include <stdexcept>
#include <vector>

#include <accdec/files/process.hpp>
#include <accdec/program/read/run_rs274.hpp>

namespace accdec {

std::string interpreted(const std::filesystem::path& program, const std::filesystem::path& tool_table) {
  std::vector<std::string> arguments{"rs274", "-g"};
  if (!tool_table.empty() && !std::filesystem::is_regular_file(tool_table)) {
    throw std::invalid_argument(tool_table.string() + ": no such tool table (--tool-table)");
  }
  if (!tool_table.empty()) arguments.insert(arguments.end(), {"-t", tool_table.string()});
  arguments.push_back(program.string());
  ProcessOutput done;
  try {
    done = run_process(arguments, "", "linuxcnc-uspace");
  } catch (const std::runtime_error& missing) {
    throw std::invalid_argument(
        program.string() + ": uses parameters, expressions or O words, which LinuxCNC's rs274 runs: " + missing.what() +
        "; apt-get install linuxcnc-uspace");
  }
  if (done.exit_code != 0 || done.output.find("PROGRAM_END") == std::string::npos) {
    const bool tool = tool_table.empty() && done.errors.find("tool table") != std::string::npos;
    throw std::invalid_argument(program.string() + ": refused by rs274: " + done.errors +
                                (tool ? "\nname your tool table: --tool-table FILE" : ""));
  }
  return std::move(done.output);
}

}  // namespace accdec
