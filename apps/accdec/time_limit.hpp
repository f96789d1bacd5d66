#pragma once

#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

namespace accdec::cli {

/// Ends the program when the time is over, wherever it is. For commands that write no file.
class TimeLimit {
 public:
  /// @param seconds  from now  @param last_words  on standard error  @param exit_code  of the program
  TimeLimit(double seconds, std::string last_words, int exit_code);
  /// The command has ended in time.
  ~TimeLimit();
  TimeLimit(const TimeLimit&) = delete;
  TimeLimit& operator=(const TimeLimit&) = delete;

 private:
  std::mutex mutex_;
  std::condition_variable ending_;
  bool ended_ = false;
  std::thread watching_;
};

}  // namespace accdec::cli
