#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

namespace accdec::cli {

/// Progress on standard error. On a terminal: one line with the time since the beginning and the latest news, rewritten
/// every second to show that work goes on. Elsewhere: after the first second every piece of news as a line of its own,
/// and nothing in between.
class StatusLine {
 public:
  enum class Lines { news, none };  ///< what is written where standard error is no terminal
  /// @param quiet  writes nothing at all  @param at_most  s, shown beside the time; 0: not known
  explicit StatusLine(bool quiet, Lines elsewhere = Lines::news, double at_most = 0.0);
  /// Clears the line.
  ~StatusLine();
  StatusLine(const StatusLine&) = delete;
  StatusLine& operator=(const StatusLine&) = delete;

  void tell(const std::string& news);
  /// s since construction.
  double seconds() const;

 private:
  void show();

  std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
  bool quiet_, terminal_;
  Lines elsewhere_;
  double at_most_;
  std::mutex mutex_;
  std::condition_variable ending_;
  bool ended_ = false;
  std::string news_;
  std::thread ticking_;
};

/// 0:07, 12:34 or 1:02:03.
std::string clock_text(double seconds);

}  // namespace accdec::cli
