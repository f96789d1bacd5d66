#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>
#include <fstream>
#include <set>
#include <stdexcept>

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
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
  ~OrphanCare() {
    if (group_ > 0) ::kill(-group_, SIGKILL);
    for (int round = 0; round < 1000; ++round) {
      bool any = false;
      for (const pid_t child : children()) {
        if (before_.count(child) > 0) continue;
        any = true;
        ::kill(child, SIGKILL);
        int status = 0;
        while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
        }
      }
      if (!any) break;
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

/// Becomes the program; reports errno to `errors` if that fails.
[[noreturn]] void become(const std::vector<char*>& argv, const std::string& folder, const ProcessLimits& limits,
                         int output, int errors) {
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_FSIZE, limits.most_file_bytes);
  sigset_t none;
  sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  const int empty = ::open("/dev/null", O_RDONLY);
  if (empty >= 0 && ::dup2(empty, 0) >= 0 && ::dup2(output, 1) >= 0 && ::dup2(output, 2) >= 0 &&
      ::chdir(folder.c_str()) == 0)
    ::execvp(argv[0], argv.data());
  const int error = errno;
  [[maybe_unused]] const ssize_t sent = ::write(errors, &error, sizeof error);
  ::_exit(127);
}

/// Reads until the program ends, its output ends and it is waited for, or a limit is broken.
void watch(pid_t child, int output, const ProcessLimits& limits, Clock::time_point began, LimitedOutput& result) {
  ::fcntl(output, F_SETFL, O_NONBLOCK);
  std::array<char, 65536> buffer{};
  const auto drain = [&] {
    for (ssize_t got = 0; (got = ::read(output, buffer.data(), buffer.size())) > 0;) {
      const std::size_t room = limits.most_output - result.output.size();
      result.output.append(buffer.data(), std::min(room, static_cast<std::size_t>(got)));
      if (static_cast<std::size_t>(got) > room) return false;
    }
    return true;
  };
  for (int status = 0;;) {
    const bool ended = ::waitpid(child, &status, WNOHANG) == child;
    if (!drain()) {
      result.stopped = fmt::format("it printed more than {} bytes", limits.most_output);
      return;
    }
    if (ended) {
      result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
      if (result.exit_code == 128 + SIGXFSZ)
        result.stopped = fmt::format("it wrote a file of more than {} bytes", limits.most_file_bytes);
      return;
    }
    if (seconds_since(began) > limits.seconds) {
      result.stopped = fmt::format("it ran longer than {:g} s", limits.seconds);
      return;
    }
    pollfd wait{output, POLLIN, 0};
    ::poll(&wait, 1, 2);
    if ((wait.revents & POLLHUP) != 0) ::usleep(1000);
  }
}

}  // namespace

LimitedOutput run_limited(const std::vector<std::string>& arguments, const std::string& folder,
                          const ProcessLimits& limits) {
  std::vector<char*> argv;
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  Pipe output, errors;
  OrphanCare care;
  const auto began = Clock::now();
  const pid_t child = ::fork();
  if (child < 0) throw std::runtime_error(fmt::format("{} cannot be started: {}", arguments[0], std::strerror(errno)));
  if (child == 0) become(argv, folder, limits, output.ends[1], errors.ends[1]);
  ::setpgid(child, child);
  care.guard(child);
  output.close(1);
  errors.close(1);
  int error = 0;
  if (::read(errors.ends[0], &error, sizeof error) == sizeof error)
    throw std::runtime_error(fmt::format("{} cannot be started: {}", arguments[0], std::strerror(error)));
  LimitedOutput result;
  watch(child, output.ends[0], limits, began, result);
  result.seconds = seconds_since(began);
  return result;
}

}  // namespace accdec
