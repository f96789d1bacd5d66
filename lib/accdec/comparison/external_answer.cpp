#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstdlib>
#include <iterator>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include <accdec/comparison/external_answer.hpp>
#include <accdec/files/shown_text.hpp>

namespace accdec::comparison {
namespace {

using solvers::Claim;

/// A word that is a number: infinite if it is too large, and 0 or below the normal range if it is small.
std::optional<double> parsed_number(const std::string& word) {
  double x = 0.0;
  const bool plus = word.starts_with('+') && !word.starts_with("+-");  // from_chars knows no plus
  const auto [end, error] = std::from_chars(word.data() + (plus ? 1 : 0), word.data() + word.size(), x);
  if (word.empty() || end != word.data() + word.size() || error == std::errc::invalid_argument) return std::nullopt;
  return error == std::errc::result_out_of_range ? std::strtod(word.c_str(), nullptr) : x;
}

double number_of(const std::string& word) {
  const std::optional<double> x = parsed_number(word);
  if (!x)
    throw std::invalid_argument(
        fmt::format("its answer has \"{}\" where a number belongs", printable(word.substr(0, 40))));
  return *x;
}

Claim claim_of_code(int code) {
  if (code >= 0 && code < 100) return Claim::solved;
  if (code >= 100 && code < 200) return Claim::acceptable;
  if (code >= 200 && code < 300) return Claim::infeasible;
  if (code >= 300 && code < 400) return Claim::unbounded;
  if (code >= 400 && code < 500) return Claim::time_limit;
  return Claim::failed;
}

/// Capital letters as small ones.
std::string in_small(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

bool says(const std::string& line, const char* word) {
  return line.find(word) != std::string::npos;
}

/// Whether a line that tells of no answer leaves open whether there is one.
bool leaves_open(const std::string& line) {
  if (says(line, "infeasible") && says(line, "unbounded")) return true;  // one of the two
  if (says(line, "no feasible") && says(line, "found")) return true;     // the search ended, nothing is proved
  constexpr const char* words[] = {"not infeasible", "not unbounded", "not proven", "not proved", "may be",
                                   "might be",       "could be",      "possibly",   "probably",   "infeasible (inter"};
  return std::any_of(std::begin(words), std::end(words), [&](const char* word) { return says(line, word); });
}

/// The claim in a line of a solver's words, if there is one.
std::optional<Claim> claim_in(const std::string& line) {
  constexpr std::pair<const char*, Claim> words[] = {{"unbounded", Claim::unbounded},
                                                     {"time limit", Claim::time_limit},
                                                     {"stopped on time", Claim::time_limit},
                                                     {"non-optimal", Claim::acceptable},
                                                     {"sub-optimal", Claim::acceptable},
                                                     {"suboptimal", Claim::acceptable},
                                                     {"infeasible", Claim::infeasible},
                                                     {"no feasible", Claim::infeasible},
                                                     {"no integer feasible", Claim::infeasible},
                                                     {"no primal feasible", Claim::infeasible},
                                                     {"integer empty", Claim::infeasible},
                                                     {"integer undefined", Claim::failed},
                                                     {"no optimal", Claim::failed},
                                                     {"solution not found", Claim::failed},
                                                     {"not be optimal", Claim::acceptable},
                                                     {"near-optimal", Claim::acceptable},
                                                     {"iteration limit", Claim::failed},
                                                     {"not optimal", Claim::acceptable},
                                                     {"optimality not", Claim::acceptable},
                                                     {"not proven", Claim::acceptable},
                                                     {"optimal", Claim::solved}};
  // Names of options and of tests, no claims.
  if (line.find("optimality") != std::string::npos && line.find(" not") == std::string::npos) return std::nullopt;
  const bool no_answer = says(line, "infeasible") || says(line, "unbounded") || says(line, "no feasible");
  if (no_answer && !says(line, "time limit") && leaves_open(line)) return Claim::failed;
  for (const auto& [word, claim] : words) {
    if (says(line, word)) return claim;
  }
  return std::nullopt;
}

/// Whether a heading says that the next line is the state of a point: HiGHS writes "Infeasible" there if it found none.
bool heads_point(const std::string& line) {
  return line.starts_with("# primal solution") || line.starts_with("# dual solution");
}

/// The number of a name X1, X2, ..; 0 for any other word.
std::size_t column_of(const std::string& word) {
  std::size_t number = 0;
  if (word.size() < 2 || (word[0] != 'X' && word[0] != 'x')) return 0;
  const auto [end, error] = std::from_chars(word.data() + 1, word.data() + word.size(), number);
  return error == std::errc() && end == word.data() + word.size() ? number : 0;
}

/// The first number among the rest of a line's words; "*" and the like may stand before it.
std::optional<double> number_after(std::istringstream& words) {
  for (std::string word; words >> word;) {
    if (const std::optional<double> x = parsed_number(word)) return x;
  }
  return std::nullopt;
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
        fmt::format("its solution has {} values of {} variables, and {} multipliers; the problem has {} variables",
                    values, wanted, duals, columns));
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
  if (line.ends_with('\r')) line.pop_back();
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
    throw std::invalid_argument(fmt::format(
        "its answer has {}{} {}; the problem has {} variables", answer.x.size() > columns ? "more than " : "",
        std::min(answer.x.size(), columns), std::min(answer.x.size(), columns) == 1 ? "value" : "values", columns));
  return answer;
}

ExternalAnswer read_names(const std::string& text, std::size_t columns) {
  std::istringstream in(text);
  ExternalAnswer answer;
  std::optional<Claim> claim;
  // Multipliers may follow under the same names, behind a line that says so. The first list is the answer.
  std::vector<int> list_of(columns);
  int list = 1;
  bool of_point = false;
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::size_t column = 0;
    for (std::string word; column == 0 && words >> word;) column = column_of(word);
    const std::optional<double> value = column > 0 ? number_after(words) : std::nullopt;
    if (value) {
      if (column > columns)
        throw std::invalid_argument(fmt::format("its answer names X{}; the problem has {} variables", column, columns));
      answer.x.resize(columns, 0.0);
      int& seen = list_of[column - 1];
      if (seen == list) throw std::invalid_argument(fmt::format("its answer names X{} twice", column));
      if (seen == 0) answer.x[column - 1] = *value, seen = list;
      continue;
    }
    ++list;
    if (answer.x.empty()) {
      // The last word before the values: a log tells of relaxations and limits first.
      const std::string small = in_small(line);
      const auto found = std::exchange(of_point, heads_point(small)) ? std::nullopt : claim_in(small);
      if (found) claim = found, answer.message = printable(line.substr(0, 200));
    }
  }
  if (!claim && answer.x.empty()) throw std::invalid_argument("its answer names no variable and says nothing known");
  answer.claim = claim.value_or(Claim::acceptable);
  if (answer.claim == Claim::infeasible) answer.x.clear();
  return answer;
}

ExternalAnswer read_answer(const std::string& kind, const std::string& text, std::size_t columns) {
  if (kind == "sol") return read_sol(text, columns);
  return kind == "values" ? read_values(text, columns) : read_names(text, columns);
}

}  // namespace accdec::comparison
