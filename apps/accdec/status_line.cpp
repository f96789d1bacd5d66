#include "status_line.hpp"

#include <cmath>
#include <csignal>
#include <cstdio>

#include <sys/ioctl.h>
#include <unistd.h>

#include <fmt/format.h>

#include <accdec/files.hpp>

#include "terminal.hpp"

namespace accdec::cli {
namespace {

/// Past the buffers of stdio, whose locks a process forked at the wrong moment would inherit taken.
void put(const std::string& text) {
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, text.data(), text.size());
}

constexpr const char* clear_line = "\r\x1b[K";
constexpr double silent = 1.0;  // s

}  // namespace

std::string clock_text(double seconds) {
  const long s = std::lround(seconds);
  return s < 3600 ? fmt::format("{}:{:02}", s / 60, s % 60)
                  : fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
}

StatusLine::StatusLine(bool quiet, Lines elsewhere, double at_most)
    : quiet_(quiet), terminal_(!quiet && is_terminal(stderr)), elsewhere_(elsewhere), at_most_(at_most) {
  if (!terminal_) return;
  // Signals are for the thread that works.
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  ticking_ = std::thread([this] {
    std::unique_lock lock(mutex_);
    while (!ending_.wait_for(lock, std::chrono::seconds(1), [this] { return ended_; })) show();
  });
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

StatusLine::~StatusLine() {
  if (!terminal_) return;
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  ending_.notify_all();
  ticking_.join();
  put(clear_line);
}

void StatusLine::tell(const std::string& news) {
  if (quiet_) return;
  if (!terminal_) {
    if (elsewhere_ == Lines::news && seconds() >= silent) put(news + "\n");
    return;
  }
  const std::lock_guard lock(mutex_);
  news_ = news;
  show();
}

void StatusLine::show() {
  winsize size{};
  // A line that wraps cannot be rewritten.
  const std::size_t width = ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1 ? size.ws_col - 1U : 79U;
  const std::string limit = at_most_ > 0.0 ? " of at most " + clock_text(at_most_) : "";
  put(clear_line + fmt::format("{}{}  {}", clock_text(seconds()), limit, news_).substr(0, width));
}

double StatusLine::seconds() const {
  return seconds_since(began_);
}

}  // namespace accdec::cli
