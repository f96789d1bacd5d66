#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <functional>
#include <stdexcept>

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fmt/format.h>

#include <accdec/files/pipe.hpp>
#include <accdec/files/process.hpp>

extern char** environ;

namespace accdec {
namespace {

std::atomic<pid_t> running{0};  // the last child of run_process; 0: none

/// Blocks SIGPIPE in this thread while it lives: a child that stops reading early must not end us.
class PipeSignalBlock {
 public:
  PipeSignalBlock() {
    sigset_t pipe_only;
    sigemptyset(&pipe_only);
    sigaddset(&pipe_only, SIGPIPE);
    pthread_sigmask(SIG_BLOCK, &pipe_only, &before_);
  }
  ~PipeSignalBlock() {
    if (!sigismember(&before_, SIGPIPE)) {
      sigset_t pipe_only;
      sigemptyset(&pipe_only);
      sigaddset(&pipe_only, SIGPIPE);
      const timespec now{};
      while (sigtimedwait(&pipe_only, nullptr, &now) > 0) {
      }
    }
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  const sigset_t& before() const { return before_; }

 private:
  sigset_t before_{};
};

/// Writes the input and reads both outputs to their end.
/// @param late  asked again and again, whether to end the child
void converse(Pipe& in, Pipe& out, Pipe& err, std::string_view input, ProcessOutput& result,
              const std::function<bool()>& late) {
  constexpr int look = 100;  // ms between two looks at the clock
  ::fcntl(in.ends[1], F_SETFL, O_NONBLOCK);
  std::array<char, 65536> buffer{};
  const auto drain = [&](Pipe& pipe, std::string& text) {
    const ssize_t got = ::read(pipe.ends[0], buffer.data(), buffer.size());
    if (got > 0)
      text.append(buffer.data(), static_cast<std::size_t>(got));
    else if (got == 0 || errno != EINTR)
      pipe.close(0);
  };
  while (out.ends[0] >= 0 || err.ends[0] >= 0 || in.ends[1] >= 0) {
    if (in.ends[1] >= 0 && input.empty()) {
      in.close(1);
      continue;
    }
    std::array<pollfd, 3> wait{pollfd{in.ends[1], POLLOUT, 0}, pollfd{out.ends[0], POLLIN, 0},
                               pollfd{err.ends[0], POLLIN, 0}};
    const int ready = ::poll(wait.data(), wait.size(), look);
    if (late() && !result.killed) kill_running_process(), result.killed = true;
    if (ready < 0) {
      if (errno == EINTR) continue;
      throw std::runtime_error(fmt::format("poll: {}", std::strerror(errno)));
    }
    if (wait[0].revents != 0) {
      const ssize_t sent = ::write(in.ends[1], input.data(), input.size());
      if (sent > 0)
        input.remove_prefix(static_cast<std::size_t>(sent));
      else if (errno != EINTR && errno != EAGAIN)
        input = {};  // it reads no more
    }
    if (wait[1].revents != 0) drain(out, result.output);
    if (wait[2].revents != 0) drain(err, result.errors);
  }
}

}  // namespace

void kill_running_process() {
  if (const pid_t child = running.exchange(0); child > 0) ::kill(child, SIGKILL);
}

ProcessOutput run_process(const std::vector<std::string>& arguments, std::string_view input, const std::string& package,
                          const Deadline& deadline, std::size_t most) {
  Pipe in, out, err;
  const PipeSignalBlock block;
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, in.ends[0], 0);
  posix_spawn_file_actions_adddup2(&actions, out.ends[1], 1);
  posix_spawn_file_actions_adddup2(&actions, err.ends[1], 2);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
  posix_spawnattr_setsigmask(&attributes, &block.before());
  std::vector<char*> argv;
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  pid_t child = 0;
  const int error = posix_spawnp(&child, argv[0], &actions, &attributes, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  if (error == ENOENT) {
    throw MissingProgram(fmt::format("{} is not installed (Debian package {})", arguments[0], package));
  }
  if (error != 0) throw std::runtime_error(fmt::format("{} cannot be started: {}", arguments[0], std::strerror(error)));
  running.store(child);
  in.close(0);
  out.close(1);
  err.close(1);
  ProcessOutput result;
  converse(in, out, err, input, result, [&] { return deadline.over() || result.output.size() > most; });
  running.store(0);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return result;
}

}  // namespace accdec
