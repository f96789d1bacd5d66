#include <algorithm>
#include <cctype>
#include <charconv>
#include <chrono>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <fmt/format.h>

#include <accdec/files/process.hpp>
#include <accdec/files/temporaries.hpp>
#include <accdec/files/text_file.hpp>
#include <accdec/gcode/canonical_call.hpp>
#include <accdec/gcode/dialects.hpp>
#include <accdec/gcode/modal_groups.hpp>
#include <accdec/gcode/number.hpp>
#include <accdec/gcode/printed_splines.hpp>
#include <accdec/gcode/run_rs274.hpp>
#include <accdec/gcode/tool_parameters.hpp>
#include <accdec/simulate.hpp>

namespace accdec {
namespace {

constexpr std::size_t interpreter_line_max = 254;  // of rs274, characters
constexpr int not_found = 127;                     // exit code of setpriv where there is no rs274
constexpr double least_seconds = 10.0;             // that rs274 has, whatever the time limit
constexpr std::size_t most_calls = 2'000'000'000;  // bytes that it prints: some 20 million moves

/// Lets one rs274 run at a time: all keep their tools in one file of the machine, and would mix them up.
class OneInterpreter {
 public:
  explicit OneInterpreter(const Deadline& deadline)
      : file_(::open((std::filesystem::temp_directory_path() / "accdec-rs274.lock").c_str(),
                     O_RDONLY | O_CREAT | O_CLOEXEC, 0666)) {
    while (file_ >= 0 && ::flock(file_, LOCK_EX | LOCK_NB) != 0) {
      if (deadline.over()) {
        ::close(file_);
        throw std::invalid_argument(
            "another accdec runs rs274, which runs once at a time: try again when it has ended");
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }
  ~OneInterpreter() {
    if (file_ >= 0) ::close(file_);  // and unlocks
  }
  OneInterpreter(const OneInterpreter&) = delete;
  OneInterpreter& operator=(const OneInterpreter&) = delete;

 private:
  int file_;
};

/// A file for rs274, gone when this is.
class TemporaryFile {
 public:
  explicit TemporaryFile(std::string_view text) {
    const int file = open_temporary((std::filesystem::temp_directory_path() / "accdec-rs274").string(), name_);
    bool written = file >= 0;
    while (written && !text.empty()) {
      const ssize_t count = ::write(file, text.data(), text.size());
      written = count > 0;
      if (written) text.remove_prefix(static_cast<std::size_t>(count));
    }
    if (file >= 0 && ::close(file) == 0 && written) return;
    remove_temporary(name_);
    throw std::invalid_argument(name_ + ": cannot be written, for rs274 to read");
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() { remove_temporary(name_); }
  const std::string& name() const { return name_; }

 private:
  std::string name_;
};

std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    if (line.ends_with('\r')) line.remove_suffix(1);
    lines.push_back(line);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

/// Behind blanks and the line's own number.
std::string_view without_number(std::string_view line) {
  const std::size_t start = std::min(line.find_first_not_of(" \t"), line.size());
  if (start == line.size() || (line[start] != 'N' && line[start] != 'n')) return line.substr(start);
  const std::size_t end = line.find_first_not_of(" \t.0123456789", start + 1);
  return end == std::string_view::npos ? std::string_view() : line.substr(end);
}

/// The letters and numbers of a line, in capitals, without blanks and comments.
std::string words_of(std::string_view line) {
  std::string words;
  bool comment = false;
  for (const char c : line) {
    if (c == ';' && !comment) break;
    if (c == '(') comment = true;
    if (!comment && c != ' ' && c != '\t') words += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    if (c == ')') comment = false;
  }
  return words;
}

constexpr double inch = 0.0254;  // m; rs274 takes every tool table to be of inches

/// A tool table whose tools have one length.
std::string table_of(double length) {
  constexpr int tools = 1000;  // as many as LinuxCNC takes
  std::string table;
  for (int tool = 1; tool <= tools; ++tool) table += fmt::format("T{0} P{0} Z{1:.9f}\n", tool, length / inch);
  return table;
}

/// A tool table of mm in inches.
std::string in_inches(std::string_view table) {
  constexpr std::string_view lengths = "XYZUVWD";
  std::string out;
  for (const std::string_view line : lines_of(table)) {
    const std::string_view words = line.substr(0, line.find(';'));
    for (std::size_t i = 0; i < words.size(); ++i) {
      const auto letter = static_cast<char>(std::toupper(static_cast<unsigned char>(words[i])));
      const char* number = words.data() + i + 1;
      double value = 0.0;
      const bool length =
          lengths.find(letter) != std::string_view::npos && read_number(number, words.data() + words.size(), value);
      out += length ? fmt::format("{}{:.9f}", letter, value * 1e-3 / inch) : std::string(1, words[i]);
      if (length) i = static_cast<std::size_t>(number - words.data()) - 1;
    }
    out += '\n';
  }
  return out;
}

/// The message of rs274, with the user's file and line in place of the copy's.
std::string refusal(const std::string& program, std::string_view text, const std::string& copy, std::string errors) {
  // The whole name first; some messages have no folder.
  for (const std::string& name : {copy, std::filesystem::path(copy).filename().string()}) {
    for (std::size_t at = 0; (at = errors.find(name, at)) != std::string::npos; at += program.size())
      errors.replace(at, name.size(), program);
  }
  constexpr std::string_view chatter = "executing\n";
  for (std::size_t at = 0; (at = errors.find(chatter)) != std::string::npos;) errors.erase(at, chatter.size());
  for (std::size_t n = errors.find('N'); n != std::string::npos; n = errors.find('N', n + 1)) {
    const std::size_t end = std::min(errors.find_first_not_of("0123456789", n + 1), errors.size());
    if (end - n - 1 != line_number_digits) continue;
    const std::int64_t line = std::stoll(errors.substr(n + 1, line_number_digits));
    errors.erase(n, end - n);
    const std::vector<std::string_view> lines = lines_of(text);
    const std::string foreign =
        line > 0 && line <= std::ssize(lines) ? foreign_words(lines[static_cast<std::size_t>(line - 1)]) : "";
    while (errors.ends_with('\n')) errors.pop_back();
    return fmt::format("{}:{}:1: refused by rs274: {}{}{}", program, line, errors, foreign.empty() ? "" : "\n",
                       foreign);
  }
  return fmt::format("{}: refused by rs274: {}", program, errors);
}

/// With `line` 0 a line that has no number here.
std::string place_of_line(const std::string& program, std::int64_t line) {
  if (line > 0) return fmt::format("{}:{}:1", program, line);
  return program + ": a subroutine in a file of its own";
}

/// The name behind an O word before `keyword`, as rs274 reads it; empty if the line has another.
std::string name_before(const std::string& words, std::string_view keyword) {
  const std::size_t named = words.find('>'), at = words.find(keyword, named == std::string::npos ? 1 : named);
  if (!words.starts_with('O') || at == std::string::npos) return "";
  std::string name = words.substr(1, at - 1);
  std::erase_if(name, [](char c) { return c == '<' || c == '>'; });
  std::ranges::transform(name, name.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return name;
}

/// Refuses parameters of tools in subroutines that rs274 takes from files of their own, in the folder it runs in.
void refuse_parameters_of_subroutines(std::string_view text, const ProgramTools& tools, std::set<std::string>& seen) {
  std::set<std::string> called;
  for (const std::string_view line : lines_of(text)) {
    const std::string words = words_of(without_number(line));
    if (const std::string name = name_before(words, "SUB"); !name.empty()) seen.insert(name);
    if (const std::string name = name_before(words, "CALL"); !name.empty()) called.insert(name);
  }
  for (const std::string& name : called) {
    const std::string file = name + ".ngc";
    if (name.find('/') != std::string::npos || !seen.insert(name).second || !std::filesystem::is_regular_file(file))
      continue;
    const std::string own = read_text_file(file, result_file_limit);
    refuse_tool_parameters(file, own, tools);
    refuse_parameters_of_subroutines(own, tools, seen);
  }
}

constexpr std::string_view of_a_tool = "of a tool, which LinuxCNC has in its tool table:";

/// rs274 has tools of its own where it is given none: lengths and diameters that nobody meant.
void refuse_own_tools(const std::string& program, std::string_view text, std::string_view calls,
                      const ProgramTools& tools) {
  if (!tools.table.empty()) return;
  const std::vector<std::string_view> lines = lines_of(text);
  for (const std::string_view line : lines_of(calls)) {
    const CanonicalCall call = find_call(line);
    const bool length = call.name == "USE_TOOL_LENGTH_OFFSET" && !tools.length &&
                        line.find_first_of("123456789", call.arguments) != std::string_view::npos;
    const bool radius = call.name == "COMMENT" && line.find("cutter radius compensation on") != std::string_view::npos;
    if (!length && !radius) continue;
    // Lines of other files, for example of subroutines, have no number.
    const bool here = call.program_line > 0 && call.program_line <= std::ssize(lines);
    const std::int64_t number = here ? call.program_line : 0;
    const std::string words = here ? words_of(lines[static_cast<std::size_t>(number - 1)]) : "";
    // With the length or diameter as words of the line itself.
    if (words.find(length ? "G43.1" : "G41.1") != std::string::npos || words.find("G42.1") != std::string::npos)
      continue;
    if (length) throw std::invalid_argument(no_tool_length(program, number));
    throw std::invalid_argument(fmt::format("{}: G41 and G42 take the diameter {} --tool-table FILE",
                                            place_of_line(program, number), of_a_tool));
  }
}

/// One length for every tool leaves nothing for the program to set.
void refuse_set_tools(const std::string& program, std::string_view calls, const ProgramTools& tools) {
  if (!tools.length) return;
  for (const std::string_view line : lines_of(calls)) {
    const CanonicalCall call = find_call(line);
    if (call.name != "SET_TOOL_TABLE_ENTRY") continue;
    const std::string where = call.program_line > 0 ? fmt::format(":{}:1", call.program_line) : "";
    throw std::invalid_argument(fmt::format(
        "{}{}: G10 L1, L10 and L11 set tools, whose lengths --tool-length sets: leave out these lines, or give a tool "
        "table by --tool-table FILE in place of --tool-length",
        program, where));
  }
}

/// A line of rs274's copy, with others around it if it is a spline and they are not too long.
std::string numbered_line(std::string_view line, const std::string& words, const std::string& number, bool& open) {
  const std::vector<std::string> lines = lines_with_spline(words, line, number, open);
  const auto fits = [](const std::string& one) { return one.size() <= interpreter_line_max; };
  if (lines.empty() || !std::ranges::all_of(lines, fits)) return number + std::string(line);
  std::string all = lines.front();
  for (std::size_t i = 1; i < lines.size(); ++i) all += '\n' + lines[i];
  return all;
}

}  // namespace

std::string no_tool_length(const std::string& program, std::int64_t line) {
  return fmt::format(
      "{}: G43 takes the length {} --tool-table FILE; or --tool-length 0, where the program's Z is that of the "
      "tool's tip all the time",
      place_of_line(program, line), of_a_tool);
}

std::string numbered_lines(std::string_view text) {
  std::string out;
  out.reserve(text.size() + text.size() / 2);
  std::int64_t number = 0;
  bool open = false;
  for (const std::string_view line : lines_of(text)) {
    ++number;
    const std::string_view rest = without_number(line);
    const std::string words = words_of(rest);
    const bool deleted =
        line.find_first_not_of(" \t") != std::string_view::npos && line[line.find_first_not_of(" \t")] == '/';
    const bool nothing = words.empty() || rest[0] == '%';
    const bool o_word = !rest.empty() && (rest[0] == 'O' || rest[0] == 'o');
    if (!deleted && (nothing || o_word || rest.size() + line_number_digits + 1 > interpreter_line_max))
      out += line;
    else if (!deleted)
      out += numbered_line(rest, words, fmt::format("N{:0{}}", number, line_number_digits), open);
    out += '\n';
  }
  return out;
}

Toolpath read_interpreted(const std::filesystem::path& program, const ProgramTools& tools, const Machine& machine,
                          const ToolpathOptions& options, const Deadline& deadline) {
  const auto began = std::chrono::steady_clock::now();
  const std::string name = program.string(), text = read_text_file(name, result_file_limit);
  if (!tools.table.empty() && !std::filesystem::is_regular_file(tools.table))
    throw std::invalid_argument(tools.table + ": no such tool table (--tool-table)");
  refuse_tool_parameters(name, text, tools);
  std::set<std::string> seen;
  refuse_parameters_of_subroutines(text, tools, seen);
  const TemporaryFile copy(numbered_lines(text));
  std::optional<TemporaryFile> table;
  if (!tools.table.empty() && !tools.table_in_inch)
    table.emplace(in_inches(read_text_file(tools.table)));
  else if (tools.table.empty() && tools.length)
    table.emplace(table_of(*tools.length));
  // rs274 goes on when nobody reads what it prints. So it is killed when this process ends, however that is.
  std::vector<std::string> arguments{"setpriv", "--pdeathsig", "KILL", "rs274", "-g"};
  if (table || !tools.table.empty()) arguments.insert(arguments.end(), {"-t", table ? table->name() : tools.table});
  arguments.push_back(copy.name());
  ProcessOutput done;
  const Deadline until(std::max(least_seconds, deadline.left()));
  try {
    const OneInterpreter alone(until);
    done = run_process(arguments, "", "util-linux", until, most_calls);
  } catch (const MissingProgram&) {
    done.exit_code = not_found;
  }
  if (done.exit_code == not_found)
    throw std::invalid_argument(
        fmt::format("rs274, which reads such programs, is not installed: apt-get install linuxcnc-uspace. accdec reads "
                    "by itself: {} {}",
                    g_supported, m_supported));
  if (done.killed)
    throw std::invalid_argument(fmt::format(
        "{}: rs274 was ended: it ran for {:.3g} s and printed {:.3g} MB of moves, at most {:g} MB are read. "
        "Does a loop of the program end? --time-limit gives it more time",
        name, seconds_since(began), 1e-6 * static_cast<double>(done.output.size()), 1e-6 * most_calls));
  if (done.exit_code != 0) throw std::invalid_argument(refusal(name, text, copy.name(), done.errors));
  refuse_own_tools(name, text, done.output, tools);
  refuse_set_tools(name, done.output, tools);
  ToolpathOptions reading = options;
  reading.read.numbered = true;
  LineSource source(name, done.output);
  return read_toolpath(source, machine, reading);
}

}  // namespace accdec
