#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <stdexcept>

#include <unistd.h>

#include <fmt/format.h>

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
    std::string name = (fs::temp_directory_path() / "accdec-external-XXXXXX").string();
    if (!::mkdtemp(name.data())) throw std::runtime_error("no temporary folder can be made in " + name);
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

double number_of(const std::string& word) {
  double x = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), x);
  if (error == std::errc::result_out_of_range) return std::numeric_limits<double>::infinity();
  if (error != std::errc() || end != word.data() + word.size())
    throw std::invalid_argument(
        fmt::format("its answer has \"{}\" where a number belongs", printable(word.substr(0, 40))));
  return x;
}

Claim claim_of_code(int code) {
  if (code >= 0 && code < 100) return Claim::solved;
  if (code >= 100 && code < 200) return Claim::acceptable;
  if (code >= 200 && code < 300) return Claim::infeasible;
  if (code >= 300 && code < 400) return Claim::unbounded;
  if (code >= 400 && code < 500) return Claim::time_limit;
  return Claim::failed;
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

ExternalAnswer read_sol(const std::string& text, std::size_t columns) {
  std::istringstream in(text);
  ExternalAnswer answer;
  std::string line, word;
  while (std::getline(in, line) && !line.starts_with("Options")) {
    if (answer.message.size() < 200) answer.message += (answer.message.empty() || line.empty() ? "" : " ") + line;
  }
  answer.message = printable(answer.message);
  if (!in) throw std::invalid_argument("its solution file has no line \"Options\"");
  const auto next = [&] {
    if (!(in >> word)) throw std::invalid_argument("its solution file ends too early");
    return number_of(word);
  };
  const double options = next();
  for (int i = 0; i < std::clamp(options, 0.0, 100.0); ++i) next();
  next();                        // rows of the problem
  const double duals = next();   // and those with a multiplier
  const double wanted = next();  // columns of the problem
  const double values = next();  // and those with a value
  if (wanted != static_cast<double>(columns) || (values != wanted && values != 0.0) || !(duals >= 0.0) || duals > 1e9)
    throw std::invalid_argument(
        fmt::format("its solution has {} values; the problem has {} variables", values, columns));
  for (double i = 0; i < duals; ++i) next();
  for (double i = 0; i < values; ++i) answer.x.push_back(next());
  if (in >> word && word == "objno") {
    next();
    answer.claim = claim_of_code(static_cast<int>(std::clamp(next(), -1.0, 1000.0)));
  }
  return answer;
}

ExternalAnswer read_values(const std::string& text, std::size_t columns) {
  std::istringstream in(text);
  ExternalAnswer answer;
  std::string line;
  std::getline(in, line);
  constexpr std::array claims{Claim::solved,    Claim::acceptable, Claim::infeasible,
                              Claim::unbounded, Claim::failed,     Claim::time_limit};
  const auto claim = std::find_if(claims.begin(), claims.end(), [&](Claim c) { return solvers::to_string(c) == line; });
  if (claim == claims.end())
    throw std::invalid_argument(
        fmt::format("its answer begins with \"{}\", which is no claim", printable(line.substr(0, 40))));
  answer.claim = *claim;
  for (std::string word; in >> word;) {
    answer.x.push_back(number_of(word));
    if (answer.x.size() > columns) break;
  }
  if (!answer.x.empty() && answer.x.size() != columns)
    throw std::invalid_argument(fmt::format("its answer has {}{} values; the problem has {} variables",
                                            answer.x.size() > columns ? "more than " : "",
                                            std::min(answer.x.size(), columns), columns));
  return answer;
}

solvers::Capabilities ExternalSolver::capabilities() const {
  solvers::Capabilities can;
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
    text = external_.reads == "nl" ? instances::nl_text(instance) : instances::cbf_text(instance);
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
    if (!output.stopped.empty()) {
      result.claim = output.seconds >= limits.seconds ? Claim::time_limit : Claim::failed;
      result.message = "killed: " + output.stopped;
      return result;
    }
    result.message = fmt::format("exit code {}: {}", output.exit_code, last_line(output.output));
    const std::string content = content_of(answer_file);
    const ExternalAnswer answer =
        external_.answer == "sol" ? read_sol(content, text.columns.size()) : read_values(content, text.columns.size());
    result.claim = answer.claim;
    if (!answer.message.empty()) result.message = answer.message;
    if (answer.x.empty()) return result;
    if (!std::all_of(answer.x.begin(), answer.x.end(), [](double v) { return std::isfinite(v); })) {
      result.claim = Claim::invalid_number;
      result.message = "its answer has a number that is not finite";
      return result;
    }
    for (std::size_t i = 0; i < n; ++i) result.x[static_cast<std::size_t>(text.variables[i])] = answer.x[i];
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
