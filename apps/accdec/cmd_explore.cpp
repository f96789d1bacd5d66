#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>

#include <fcntl.h>
#include <spawn.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fmt/format.h>

#include <accdec/files/scratch_folder.hpp>
#include <accdec/files/shown_text.hpp>
#include <accdec/simulate.hpp>
#include <accdec/solvers/module.hpp>
#include <accdec/task.hpp>

#include "command.hpp"
#include "explore/program.hpp"
#include "explore/requests.hpp"
#include "explore/server.hpp"
#include "interrupt.hpp"
#include "machines.hpp"
#include "option_checks.hpp"
#include "output.hpp"
#include "status_line.hpp"

namespace accdec::cli {
namespace {

struct ExploreArguments {
  std::string file;  ///< a task, or a program that `task` is of
  std::string task;
  bool no_browser = false;
  double free_seconds = 0.0;  ///< for plan free of a program; 0: without it
};

/// A file that sends a browser to an address, for this user alone: others read the words of a command line. It is there
/// as long as this is.
class PrivatePage {
 public:
  /// @throws std::runtime_error if there is no folder for it
  explicit PrivatePage(const std::string& address) {
    const std::string text = fmt::format(
        "<!doctype html><meta charset=\"utf-8\"><title>accdec explore</title>"
        "<meta http-equiv=\"refresh\" content=\"0; url={0}\"><p><a href=\"{0}\">accdec explore</a></p>\n",
        address);
    const int file = ::open(path().c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, S_IRUSR | S_IWUSR);
    written_ = file >= 0 && ::write(file, text.data(), text.size()) == static_cast<ssize_t>(text.size());
    if (file >= 0) ::close(file);
  }

  bool written() const { return written_; }
  std::filesystem::path path() const { return folder_ / "page.html"; }

 private:
  ScratchFolder folder_{"accdec-explore"};
  bool written_ = false;
};

/// Whether a program has ended well, or goes on for longer than it takes to find out that there is no browser.
bool ends_well(pid_t child) {
  using namespace std::chrono_literals;
  int status = 0;
  for (int i = 0; i < 20; ++i) {
    const pid_t ended = ::waitpid(child, &status, WNOHANG);
    if (ended != 0) return ended == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
    std::this_thread::sleep_for(50ms);
  }
  return true;
}

/// The desktop's browser, which may outlive this program. @returns whether it opens
bool open_browser(const std::filesystem::path& page) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  for (const int file : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    posix_spawn_file_actions_addopen(&actions, file, "/dev/null", O_RDWR, 0);
  std::string program = "xdg-open", argument = "file://" + page.string();
  char* const words[] = {program.data(), argument.data(), nullptr};
  pid_t child = 0;
  const bool opened = ::posix_spawnp(&child, program.c_str(), &actions, nullptr, words, environ) == 0;
  posix_spawn_file_actions_destroy(&actions);
  return opened && ends_well(child);
}

/// The text that the page begins with.
std::string start_of(const ExploreArguments& arguments, const Context& context) {
  if (!arguments.task.empty()) {
    const Task task = read_task(
        arguments.task,
        {.require_corners = false, .axes = static_cast<int>(program_axis_count), .response = Considered::all});
    warn(task, arguments.task, context);
    StatusLine status(context.quiet);
    return explore::program_start_json(arguments.file, task, arguments.free_seconds,
                                       [&](const std::string& line) { status.tell(line); });
  }
  const bool given = !arguments.file.empty();
  const Task task = given ? read_task(arguments.file, {.response = Considered::all})
                          : parse_task(machine_file(first_machine).text, std::string(first_machine));
  explore::require_small(task.corners.size());
  if (given) warn(task, arguments.file, context);
  return explore::start_json(task, arguments.file);
}

void run(const ExploreArguments& arguments, Context& context) {
  if (arguments.file.empty() && !arguments.task.empty())
    throw std::invalid_argument("--task goes with a program: accdec explore PROGRAM.ngc --task TASK.toml");
  if (arguments.task.empty() && arguments.free_seconds > 0.0)
    throw std::invalid_argument("--free goes with a program: accdec explore PROGRAM.ngc --task TASK.toml --free 10");
  const std::string start = start_of(arguments, context);
  const std::string page = arguments.task.empty() ? "" : "program.html";
  const Interrupt interrupt;
  const auto serve =
      solvers::module_function<decltype(explore::accdec_explore_serve)>("explore", "accdec_explore_serve");
  std::optional<PrivatePage> file;
  serve(
      {start, explore::page_files(), explore::answer},
      [&](const std::string& address) {
        try {
          if (!arguments.no_browser) file.emplace(address + page);
        } catch (const std::runtime_error&) {  // without a folder for it the address is printed
        }
        const bool opened = file && file->written() && open_browser(file->path());
        if (context.quiet && opened) return;
        fmt::print("{}\n", address + page);
        if (!context.quiet)
          fmt::print("The page is {}. It ends with its window, or by Ctrl-C.\n",
                     opened ? "being opened" : "at this address");
        std::fflush(stdout);
      },
      Interrupt::asked());
  context.exit_code = exit_ok;
}

}  // namespace

void add_explore(CLI::App& app, Context& context) {
  auto arguments = std::make_shared<ExploreArguments>();
  CLI::App* command = app.add_subcommand(
      "explore",
      "Open a page in the browser with a slider for every number of a task; each design is verified and proved");
  command
      ->add_option("file", arguments->file,
                   "Task to begin with (default: one of those of init); with --task a program to look at")
      ->type_name("TASK.toml|PROGRAM.ngc");
  command
      ->add_option("--task", arguments->task, "Task for the program, as for accdec program; the page shows its plans")
      ->type_name("TASK.toml");
  command
      ->add_option("--free", arguments->free_seconds,
                   "Seconds for plan free of a program, which is shown beside the others (default: not planned)")
      ->type_name("SECONDS")
      ->check(positive_number());
  command->add_flag("--no-browser", arguments->no_browser, "Print the address of the page and open no browser");
  command->callback([arguments, &context] { run(*arguments, context); });
}

}  // namespace accdec::cli
