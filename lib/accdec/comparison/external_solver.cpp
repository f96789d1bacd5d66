#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <stdexcept>

#include <unistd.h>

#include <fmt/format.h>

#include <accdec/comparison/external_answer.hpp>
#include <accdec/comparison/external_solver.hpp>
#include <accdec/comparison/recorded_problem.hpp>
#include <accdec/files/limited_process.hpp>
#include <accdec/files/shown_text.hpp>
#include <accdec/instances/instance.hpp>

namespace accdec::comparison {
namespace {

namespace fs = std::filesystem;
using solvers::Claim;

/// A file of more bytes is no answer to a problem of at most 10^5 variables.
constexpr std::uintmax_t most_answer_bytes = 100'000'000;

class ScratchFolder {
 public:
  ScratchFolder() {
    std::error_code missing;
    std::string name = (fs::temp_directory_path(missing) / "accdec-external-XXXXXX").string();
    if (missing || !::mkdtemp(name.data()))
      throw std::runtime_error("no temporary folder can be made; TMPDIR must name a folder that can be written to");
    path_ = name;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  fs::path operator/(const std::string& name) const { return path_ / name; }
  std::string string() const { return path_.string(); }

 private:
  fs::path path_;
};

bool has_binary(const instances::Instance& instance) {
  return std::any_of(instance.variables.begin(), instance.variables.end(), [](const auto& v) { return v.binary; });
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size()))
    text.replace(at, what.size(), by);
  return text;
}

/// The words of a command with its places filled in.
std::vector<std::string> words_of(const External& external, const std::string& problem, const std::string& answer,
                                  double seconds) {
  std::vector<std::string> words;
  std::istringstream command(external.command);
  for (std::string word; command >> word;) {
    word = replaced(word, "{" + external.reads + "}", problem);
    word = replaced(word, "{answer}", answer);
    word = replaced(word, "{seconds}", fmt::format("{:g}", seconds));
    words.push_back(replaced(word, "{suite}", external.folder));
  }
  return words;
}

std::string last_line(const std::string& output) {
  std::istringstream in(output);
  std::string last;
  for (std::string line; std::getline(in, line);) {
    if (!line.empty()) last = line;
  }
  return printable(last.substr(0, 200));
}

std::string content_of(const fs::path& path) {
  std::error_code error;
  if (!fs::is_regular_file(fs::symlink_status(path, error))) throw std::invalid_argument("it wrote no answer");
  if (fs::file_size(path) > most_answer_bytes) throw std::invalid_argument("its answer has more than 100 MB");
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

solvers::Capabilities ExternalSolver::capabilities() const {
  solvers::Capabilities can;
  can.integers = true;
  can.uses_hessian = external_.reads == "nl";
  return can;
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
  const ScratchFolder folder;
  const fs::path file = folder / ("problem." + external_.reads), answer_file = folder / "problem.sol";
  std::ofstream(file, std::ios::binary) << text.content;
  const std::vector<std::string> words = words_of(external_, file.string(), answer_file.string(), options.time_limit);
  ProcessLimits limits;
  limits.seconds = options.time_limit;
  try {
    const LimitedOutput output = run_limited(words, folder.string(), limits);
    result.wall_time = output.seconds;
    if (!output.stopped.empty()) {
      result.claim = output.seconds >= limits.seconds ? Claim::time_limit : Claim::failed;
      result.message = "killed: " + output.stopped;
      return result;
    }
    result.message = fmt::format("exit code {}: {}", output.exit_code, last_line(output.output));
    const bool printed = external_.answer == "names" && external_.command.find("{answer}") == std::string::npos;
    const ExternalAnswer answer =
        read_answer(external_.answer, printed ? output.output : content_of(answer_file), text.columns.size());
    result.claim = answer.claim;
    if (!answer.message.empty()) result.message = answer.message;
    if (answer.x.empty()) return result;
    if (!std::all_of(answer.x.begin(), answer.x.end(), [](double v) { return std::isfinite(v); })) {
      result.claim = Claim::invalid_number;
      result.message = "its answer has a number that is not finite";
      return result;
    }
    for (std::size_t i = 0; i < answer.x.size(); ++i) {
      if (const auto variable = static_cast<std::size_t>(text.variables[i]); variable < n)
        result.x[variable] = answer.x[i];
    }
    result.claimed_objective = problem.objective(result.x);  // this also records the point
    std::vector<double> rows(static_cast<std::size_t>(problem.num_rows()));
    problem.rows(result.x, rows);
  } catch (const std::exception& error) {
    result.claim = Claim::failed;
    result.message = fmt::format("{}{}{}", error.what(), result.message.empty() ? "" : "; ", result.message);
  }
  return result;
}

}  // namespace accdec::comparison
