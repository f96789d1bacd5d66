#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <utility>

#include <unistd.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/comparison/external_answer.hpp>
#include <accdec/comparison/external_solver.hpp>
#include <accdec/comparison/recorded_problem.hpp>
#include <accdec/files/limited_process.hpp>
#include <accdec/files/scratch_folder.hpp>
#include <accdec/files/shown_text.hpp>
#include <accdec/instances/instance.hpp>

namespace accdec::comparison {
namespace {

namespace fs = std::filesystem;
using solvers::Claim;

/// A file of more bytes is no answer to a problem of at most 10^5 variables.
constexpr std::uintmax_t most_answer_bytes = 100'000'000;
/// Linux has signals up to this one. A shell's exit code for a program that one ended is 128 more.
constexpr int last_signal = 64;

/// "{nl}, {answer}"
std::string allowed_words(const std::map<std::string, std::string>& places) {
  std::vector<std::string> words;
  for (const auto& [name, value] : places) words.push_back("{" + name + "}");
  return fmt::format("{}", fmt::join(words, ", "));
}

bool has_binary(const instances::Instance& instance) {
  return std::any_of(instance.variables.begin(), instance.variables.end(), [](const auto& v) { return v.binary; });
}

std::string last_line(const std::string& output) {
  std::istringstream in(output);
  std::string last;
  for (std::string line; std::getline(in, line);) {
    if (!line.empty()) last = line;
  }
  return printable(last.substr(0, 200));
}

/// A run has one core. Libraries of linear algebra would start a thread for every core of the machine, and wait for it.
void ask_for_one_thread() {
  for (const char* name : {"OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"}) ::setenv(name, "1", 0);
}

std::string content_of(const fs::path& path) {
  std::error_code error;
  if (!fs::is_regular_file(fs::symlink_status(path, error))) throw std::invalid_argument("it wrote no answer");
  if (fs::file_size(path) > most_answer_bytes) throw std::invalid_argument("its answer has more than 100 MB");
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Redirections and operators of a shell would be arguments of the program.
void refuse_operator(const std::string& word) {
  constexpr std::array signs{">", "<", "|", "&", "1>", "2>"};
  const auto begins = [&](const char* sign) { return word.starts_with(sign); };
  if (word == ";" || std::any_of(signs.begin(), signs.end(), begins))
    throw std::invalid_argument(fmt::format(
        "\"{}\" in `command` would be an argument, as no shell runs; allowed are sh -c '..', and quotes around an "
        "argument",
        printable(word.substr(0, 20))));
}

}  // namespace

std::vector<std::string> command_words(const std::string& command, const std::map<std::string, std::string>& places) {
  std::vector<std::string> words;
  std::string word;
  bool begun = false, quoted = false;
  char quote = 0;
  const auto end_word = [&] {
    if (begun && !quoted) refuse_operator(word);
    if (begun) words.push_back(std::exchange(word, {}));
    begun = quoted = false;
  };
  for (std::size_t i = 0; i < command.size(); ++i) {
    const char c = command[i];
    if (quote ? c != quote : std::isspace(static_cast<unsigned char>(c)) == 0) begun = true;
    if (quote ? c == quote : c == '\'' || c == '"') {
      quote = quote ? '\0' : c;
      quoted = true;
    } else if (!quote && std::isspace(static_cast<unsigned char>(c)) != 0) {
      end_word();
    } else if (c != '{' && c != '}') {
      word += c;
    } else if (command.substr(i + 1, 1) == std::string(1, c)) {
      word += c;
      ++i;
    } else {
      const std::size_t end = command.find('}', i);
      const std::string name = command.substr(i + 1, end == std::string::npos ? end : end - i - 1);
      const auto place = c == '{' && end != std::string::npos ? places.find(name) : places.end();
      if (place == places.end())
        throw std::invalid_argument(
            fmt::format("\"{}\" in `command` stands for nothing; allowed are {}; other braces are doubled",
                        command.substr(i, std::min<std::size_t>(name.size() + 2, 20)), allowed_words(places)));
      word += place->second;
      i = end;
    }
  }
  if (quote) throw std::invalid_argument(fmt::format("a quote {} in `command` has no end", quote));
  end_word();
  return words;
}

namespace {

/// Takes the solver's answer over into the result.
/// @throws std::exception  where it cannot be read, or is not of the problem
void take_answer(const ExternalAnswer& answer, const instances::Text& text, const nlp::Problem& problem,
                 solvers::Result& result) {
  result.claim = answer.claim;
  if (!answer.message.empty()) result.message = answer.message;
  if (answer.x.empty() && (answer.claim == Claim::solved || answer.claim == Claim::acceptable))
    throw std::invalid_argument("it claims a solution, but its answer has no values");
  if (answer.x.empty()) return;
  if (!std::all_of(answer.x.begin(), answer.x.end(), [](double v) { return std::isfinite(v); })) {
    result.claim = Claim::invalid_number;
    result.message = "its answer has a number that is not finite";
    return;
  }
  for (std::size_t i = 0; i < answer.x.size(); ++i) {
    if (const auto variable = static_cast<std::size_t>(text.variables[i]); variable < result.x.size())
      result.x[variable] = answer.x[i];
  }
  for (const auto& [variable, form] : text.solved) result.x[static_cast<std::size_t>(variable)] = form(result.x);
  result.claimed_objective = problem.objective(result.x);  // this also records the point
  std::vector<double> rows(static_cast<std::size_t>(problem.num_rows()));
  problem.rows(result.x, rows);
}

}  // namespace

solvers::Capabilities ExternalSolver::capabilities() const {
  solvers::Capabilities can;
  can.integers = true;
  can.uses_hessian = external_.reads == "nl";
  return can;
}

void ExternalSolver::tell(const ProgramEnd& end) const {
  if (ended_) ended_(end);
}

solvers::Result ExternalSolver::do_solve(const nlp::Problem& problem, std::span<const double> start,
                                         const solvers::Options& options) const {
  solvers::Result result;
  const auto n = static_cast<std::size_t>(problem.num_variables());
  result.x.assign(n, std::numeric_limits<double>::quiet_NaN());
  result.claimed_objective = std::numeric_limits<double>::quiet_NaN();
  const auto* recorded = dynamic_cast<const RecordedProblem*>(&problem);
  const auto* whole = dynamic_cast<const QuadraticProblem*>(recorded ? &recorded->recorded() : &problem);
  if (!whole) throw std::invalid_argument("external solvers take problems of suites only");
  instances::Text text;
  try {
    const instances::Instance instance = instances::instance_of(*whole, start);
    if (external_.reads == "mps" && !has_binary(instance))
      throw std::invalid_argument(
          "files of MPS hold whole designs only: cones become tangents, and no answer would hold every row");
    text = instances::text_of(instance, external_.reads);
  } catch (const std::invalid_argument& reason) {
    result.claim = Claim::refused;
    result.message = reason.what();
    return result;
  }
  const ScratchFolder folder("accdec-external");
  const fs::path file = folder / ("problem." + external_.reads), answer_file = folder / "problem.sol";
  std::ofstream(file, std::ios::binary) << text.content;
  const std::vector<std::string> words =
      command_words(external_.command, {{external_.reads, file.string()},
                                        {"answer", answer_file.string()},
                                        {"seconds", fmt::format("{:g}", options.time_limit)},
                                        {"suite", external_.folder}});
  ProcessLimits limits;
  limits.seconds = options.time_limit + external_.grace;
  limits.folder_goes = true;
  limits.most_memory = static_cast<std::size_t>(external_.memory_max) * 1'000'000;
  ask_for_one_thread();
  ProgramEnd end;
  try {
    const LimitedOutput output = run_limited(words, folder.string(), limits);
    result.wall_time = output.seconds;
    const bool late = output.seconds > options.time_limit;
    end.killed = !output.stopped.empty();
    if (end.killed) {
      result.claim = output.seconds >= limits.seconds ? Claim::time_limit : Claim::failed;
      result.message = "killed: " + output.stopped;
      tell(end);
      return result;
    }
    result.message = fmt::format("exit code {}: {}", output.exit_code,
                                 last_line(output.messages.empty() ? output.output : output.messages));
    if (external_.memory_max > 0 && output.exit_code != 0)
      result.message += fmt::format(" (its processes may have {} MB each)", external_.memory_max);
    // Other statuses say nothing: csdp ends with 1 where there is no answer, and with 3 where its answer is near.
    end.crashed = output.exit_code > 128 && output.exit_code <= 128 + last_signal;
    if (end.crashed) throw std::invalid_argument(fmt::format("it was ended by signal {}", output.exit_code - 128));
    const bool printed = external_.answer != "sol" && external_.command.find("{answer}") == std::string::npos;
    const ExternalAnswer answer =
        read_answer(external_.answer, printed ? output.output : content_of(answer_file), text.columns.size());
    take_answer(answer, text, problem, result);
    if (late && result.claim != Claim::invalid_number) end.late = std::exchange(result.claim, Claim::time_limit);
  } catch (const std::exception& error) {
    const bool late = result.wall_time > options.time_limit && !end.crashed;
    result.claim = late ? Claim::time_limit : Claim::failed;
    result.message = fmt::format("{}{}{}", error.what(), result.message.empty() ? "" : "; ", result.message);
  }
  tell(end);
  return result;
}

}  // namespace accdec::comparison
