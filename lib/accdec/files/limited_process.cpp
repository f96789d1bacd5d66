#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>
#include <stdexcept>

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/signalfd.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fmt/format.h>

#include <accdec/files.hpp>
#include <accdec/files/limited_process.hpp>
#include <accdec/files/pipe.hpp>

namespace accdec {
namespace {

using Clock = std::chrono::steady_clock;

/// Children of this process's threads.
std::set<pid_t> children() {
  std::set<pid_t> found;
  std::ifstream list(fmt::format("/proc/self/task/{}/children", ::getpid()));
  for (pid_t child = 0; list >> child;) found.insert(child);
  return found;
}

/// Orphans of the program come to this process while this lives.
class OrphanCare {
 public:
  OrphanCare() : before_(children()) {
    ::prctl(PR_GET_CHILD_SUBREAPER, &was_);
    ::prctl(PR_SET_CHILD_SUBREAPER, 1);
  }
  OrphanCare(const OrphanCare&) = delete;
  OrphanCare& operator=(const OrphanCare&) = delete;
  /// Kills the group and every orphan that has come. Killing one may orphan others, so it is done until none is left.
  /// All are killed before any is waited for: hundreds may each take a while to end.
  ~OrphanCare() {
    if (group_ > 0) ::kill(-group_, SIGKILL);
    for (int round = 0; round < 1000; ++round) {
      std::set<pid_t> orphans = children();
      for (const pid_t child : before_) orphans.erase(child);
      for (const pid_t orphan : orphans) ::kill(orphan, SIGKILL);
      for (const pid_t orphan : orphans) {
        int status = 0;
        while (::waitpid(orphan, &status, 0) < 0 && errno == EINTR) {
        }
      }
      if (orphans.empty()) break;
    }
    ::prctl(PR_SET_CHILD_SUBREAPER, was_);
  }
  void guard(pid_t group) { group_ = group; }

 private:
  std::set<pid_t> before_;
  int was_ = 0;
  pid_t group_ = 0;
};

void limit(decltype(RLIMIT_CPU) what, rlim_t value) {
  const rlimit both{value, value};
  ::setrlimit(what, &both);
}

/// The words of the program, its folder and its limits.
struct Start {
  const std::vector<char*>& argv;
  const std::string& folder;
  const ProcessLimits& limits;
};

/// The program's output, and errno of a start that failed.
struct Channels {
  Pipe output, messages, failure;
};

/// Becomes the program; reports errno if that fails.
[[noreturn]] void become(const Start& start, const Channels& channels) {
  const ProcessLimits& limits = start.limits;
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_FSIZE, limits.most_file_bytes);
  if (limits.most_memory > 0) limit(RLIMIT_AS, limits.most_memory);
  sigset_t none;
  sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  const int empty = ::open("/dev/null", O_RDONLY);
  if (empty >= 0 && ::dup2(empty, 0) >= 0 && ::dup2(channels.output.ends[1], 1) >= 0 &&
      ::dup2(channels.messages.ends[1], 2) >= 0 && ::chdir(start.folder.c_str()) == 0)
    ::execvp(start.argv[0], start.argv.data());
  const int error = errno;
  [[maybe_unused]] const ssize_t sent = ::write(channels.failure.ends[1], &error, sizeof error);
  ::_exit(127);
}

int code_of(int status) {
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/// Waits until the program ends, or the caller closes its end of the lifeline. @return the program's exit code
int wait_for(pid_t program, int lifeline, int ended) {
  for (int status = 0;;) {
    if (::waitpid(program, &status, WNOHANG) == program) return code_of(status);
    std::array<pollfd, 2> either{{{lifeline, POLLIN, 0}, {ended, POLLIN, 0}}};
    ::poll(either.data(), either.size(), -1);
    if (either[0].revents != 0) return 128 + SIGKILL;
    signalfd_siginfo taken{};
    while (::read(ended, &taken, sizeof taken) > 0) {
    }
  }
}

void close_written(Channels& channels) {
  for (Pipe* pipe : {&channels.output, &channels.messages, &channels.failure}) pipe->close(1);
}

/// Stands between the caller and the program, in a group of its own. It kills all that the program started when the
/// program ends, or when the lifeline closes: so nothing outlives the caller, however the caller ends.
[[noreturn]] void stand_guard(const Start& start, Channels& channels, Pipe& lifeline) {
  ::setpgid(0, 0);
  lifeline.close(1);
  sigset_t child_ends;
  sigemptyset(&child_ends);
  sigaddset(&child_ends, SIGCHLD);
  ::sigprocmask(SIG_BLOCK, &child_ends, nullptr);
  const int ended = ::signalfd(-1, &child_ends, SFD_CLOEXEC | SFD_NONBLOCK);
  int code = 127;
  {
    OrphanCare care;
    const pid_t program = ::fork();
    if (program == 0) become(start, channels);
    if (program < 0) {
      const int error = errno;
      [[maybe_unused]] const ssize_t sent = ::write(channels.failure.ends[1], &error, sizeof error);
    }
    close_written(channels);
    if (program > 0) {
      ::setpgid(program, program);
      care.guard(program);
      code = wait_for(program, lifeline.ends[0], ended);
    }
  }
  pollfd caller{lifeline.ends[0], POLLIN, 0};
  std::error_code ignored;
  if (start.limits.folder_goes && ::poll(&caller, 1, 0) > 0) std::filesystem::remove_all(start.folder, ignored);
  ::_exit(code);
}

/// Lets the guard end what it guards. A guard that the program has stopped is killed by the care of the caller.
void release(Pipe& lifeline, pid_t guard) {
  lifeline.close(1);
  for (int tries = 0; tries < 500; ++tries) {
    if (::waitpid(guard, nullptr, WNOHANG) != 0) return;
    ::usleep(2000);
  }
}

/// Takes over what a pipe holds. @return whether there was room for it
bool drain(int pipe, std::size_t most, const std::string& beside, std::string& text) {
  std::array<char, 65536> buffer{};
  for (ssize_t got = 0; (got = ::read(pipe, buffer.data(), buffer.size())) > 0;) {
    const std::size_t room = most - text.size() - beside.size();
    text.append(buffer.data(), std::min(room, static_cast<std::size_t>(got)));
    if (static_cast<std::size_t>(got) > room) return false;
  }
  return true;
}

/// Reads until the program ends, its output ends and it is waited for, or a limit is broken.
void watch(pid_t child, const Channels& channels, const ProcessLimits& limits, Clock::time_point began,
           LimitedOutput& result) {
  const int output = channels.output.ends[0], messages = channels.messages.ends[0];
  for (const int pipe : {output, messages}) ::fcntl(pipe, F_SETFL, O_NONBLOCK);
  for (int status = 0;;) {
    const bool ended = ::waitpid(child, &status, WNOHANG) == child;
    if (!drain(output, limits.most_output, result.messages, result.output) ||
        !drain(messages, limits.most_output, result.output, result.messages)) {
      result.stopped = fmt::format("it printed more than {} bytes", limits.most_output);
      return;
    }
    if (ended) {
      result.exit_code = code_of(status);
      if (result.exit_code == 128 + SIGXFSZ)
        result.stopped = fmt::format("it wrote a file of more than {} bytes", limits.most_file_bytes);
      return;
    }
    if (seconds_since(began) > limits.seconds) {
      result.stopped = fmt::format("it ran longer than {:g} s", limits.seconds);
      return;
    }
    std::array<pollfd, 2> wait{{{output, POLLIN, 0}, {messages, POLLIN, 0}}};
    ::poll(wait.data(), wait.size(), 2);
    if (((wait[0].revents | wait[1].revents) & POLLHUP) != 0) ::usleep(1000);
  }
}

}  // namespace

LimitedOutput run_limited(const std::vector<std::string>& arguments, const std::string& folder,
                          const ProcessLimits& limits) {
  std::vector<char*> argv;
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  Channels channels;
  Pipe lifeline;
  OrphanCare care;
  const auto began = Clock::now();
  const pid_t guard = ::fork();
  if (guard < 0) throw std::runtime_error(fmt::format("{} cannot be started: {}", arguments[0], std::strerror(errno)));
  if (guard == 0) stand_guard({argv, folder, limits}, channels, lifeline);
  ::setpgid(guard, guard);
  care.guard(guard);
  close_written(channels);
  lifeline.close(0);
  int error = 0;
  if (::read(channels.failure.ends[0], &error, sizeof error) == sizeof error)
    throw std::runtime_error(fmt::format("{} cannot be started: {}", arguments[0], std::strerror(error)));
  LimitedOutput result;
  watch(guard, channels, limits, began, result);
  result.seconds = seconds_since(began);
  if (!result.stopped.empty()) release(lifeline, guard);
  return result;
}

}  // namespace accdec
