#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <memory>
#include <stdexcept>

#include <poll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fmt/format.h>

#include <accdec/batch/worker_process.hpp>
#include <accdec/files.hpp>

namespace accdec::batch {
namespace {

using Clock = std::chrono::steady_clock;

bool send_all(int socket, const void* data, std::size_t size) {
  const char* p = static_cast<const char*>(data);
  while (size > 0) {
    const ssize_t n = ::send(socket, p, size, MSG_NOSIGNAL);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    p += n;
    size -= static_cast<std::size_t>(n);
  }
  return true;
}

bool receive_all(int socket, void* data, std::size_t size) {
  char* p = static_cast<char*>(data);
  while (size > 0) {
    const ssize_t n = ::recv(socket, p, size, 0);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    p += n;
    size -= static_cast<std::size_t>(n);
  }
  return true;
}

/// A child's answer: this header, then `length` bytes of row (or of the reason, if not ok).
struct Answer {
  double seconds;
  std::uint64_t length;
  std::uint8_t ok;
};

[[noreturn]] void serve(int socket, const std::function<std::string(std::size_t)>& compute) {
  std::uint64_t index = 0;
  while (receive_all(socket, &index, sizeof index)) {
    const auto began = Clock::now();
    Answer answer{};
    std::string text;
    try {
      text = compute(static_cast<std::size_t>(index));
      answer.ok = 1;
    } catch (const std::exception& error) {
      text = error.what();
    }
    answer.seconds = seconds_since(began);
    answer.length = text.size();
    if (!send_all(socket, &answer, sizeof answer) || !send_all(socket, text.data(), text.size())) break;
  }
  // Not exit(): the child must not write the parent's buffers or run its exit handlers.
  ::_exit(0);
}

/// One child and the point it is computing.
class Worker {
 public:
  Worker(const std::function<std::string(std::size_t)>& compute, const std::vector<std::unique_ptr<Worker>>& siblings) {
    int ends[2];
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
      throw std::runtime_error(fmt::format("no socket for a worker: {}", std::strerror(errno)));
    const pid_t parent = ::getpid();
    child_ = ::fork();
    if (child_ < 0) throw std::runtime_error(fmt::format("no worker process: {}", std::strerror(errno)));
    if (child_ == 0) {
      ::prctl(PR_SET_PDEATHSIG, SIGKILL);
      if (::getppid() != parent) ::_exit(0);
      ::close(ends[0]);
      // A sibling ends when the parent's end of its socket closes. So this child must not keep a copy of that end.
      for (const auto& sibling : siblings) ::close(sibling->socket_);
      serve(ends[1], compute);
    }
    ::close(ends[1]);
    socket_ = ends[0];
  }
  ~Worker() {
    ::close(socket_);
    end();
  }
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  int socket() const { return socket_; }
  std::size_t index() const { return index_; }
  double busy_for() const { return seconds_since(began_); }

  void give(std::size_t index) {
    index_ = index;
    began_ = Clock::now();
    const std::uint64_t message = index;
    send_all(socket_, &message, sizeof message);  // a dead child is noticed as end of file
  }
  /// Takes the answer. False if the child died before it; then `reason` says how.
  bool take(Answer& answer, std::string& text, std::string& reason) {
    if (receive_all(socket_, &answer, sizeof answer)) {
      text.resize(answer.length);
      if (receive_all(socket_, text.data(), text.size())) return true;
    }
    dying_ = true;
    const int status = end();
    reason = WIFSIGNALED(status) ? fmt::format("the process computing it was ended by signal {} ({})", WTERMSIG(status),
                                               ::strsignal(WTERMSIG(status)))
                                 : "the process computing it ended early";
    return false;
  }

 private:
  /// Ends and reaps the child, once. Returns its wait status. A child that closed its socket is about to end by itself:
  /// then its own signal counts.
  int end() {
    int status = 0;
    if (child_ <= 0) return status;
    for (int tries = 0; tries < 50; ++tries) {
      if (::waitpid(child_, &status, WNOHANG) == child_) {
        child_ = -1;
        return status;
      }
      if (!dying_) break;
      ::usleep(10000);
    }
    ::kill(child_, SIGKILL);
    ::waitpid(child_, &status, 0);
    child_ = -1;
    return status;
  }

  bool dying_ = false;
  int socket_ = -1;
  pid_t child_ = -1;
  std::size_t index_ = 0;
  Clock::time_point began_;
};

}  // namespace

void run_processes(const std::vector<std::size_t>& indices, const std::function<std::string(std::size_t)>& compute,
                   const std::function<std::string(std::size_t, const std::string&)>& lost,
                   const std::function<void(std::size_t, const Entry&)>& done, int workers,
                   const std::function<double(std::size_t)>& kill_after, bool fresh_children) {
  std::size_t next = 0;
  std::vector<std::unique_ptr<Worker>> pool;
  const auto hire = [&] {
    pool.push_back(std::make_unique<Worker>(compute, pool));
    pool.back()->give(indices[next++]);
  };
  const auto dismiss = [&](std::size_t w) { pool.erase(pool.begin() + static_cast<std::ptrdiff_t>(w)); };
  while (static_cast<int>(pool.size()) < workers && next < indices.size()) hire();
  while (!pool.empty()) {
    std::vector<pollfd> waiting;
    for (const auto& w : pool) waiting.push_back({w->socket(), POLLIN, 0});
    const bool limited =
        std::any_of(pool.begin(), pool.end(), [&](const auto& w) { return kill_after(w->index()) > 0.0; });
    if (::poll(waiting.data(), waiting.size(), limited ? 50 : -1) < 0 && errno != EINTR)
      throw std::runtime_error(fmt::format("poll: {}", std::strerror(errno)));
    for (std::size_t w = pool.size(); w-- > 0;) {
      const std::size_t index = pool[w]->index();
      Entry entry;
      std::string reason;
      bool alive = true;
      if (waiting[w].revents != 0) {
        Answer answer{};
        alive = pool[w]->take(answer, entry.row, reason);
        entry.seconds = alive ? answer.seconds : pool[w]->busy_for();
        if (alive && answer.ok == 0) entry.row = lost(index, entry.row);
      } else if (const double limit = kill_after(index); limit > 0.0 && pool[w]->busy_for() > limit) {
        alive = false;
        reason = fmt::format("given up after {:g} s", limit);
        entry.seconds = pool[w]->busy_for();
      } else {
        continue;
      }
      if (!alive) {
        entry.row = lost(index, reason);
        dismiss(w);
      }
      done(index, entry);
      if (alive && fresh_children) {
        dismiss(w);
        alive = false;  // for its work: the next point gets a new child below
      }
      if (alive && next < indices.size()) {
        pool[w]->give(indices[next++]);
      } else if (alive) {
        dismiss(w);
      } else if (next < indices.size()) {
        hire();
        break;  // `waiting` no longer matches the pool
      }
    }
  }
}

}  // namespace accdec::batch
