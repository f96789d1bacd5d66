#include "time_limit.hpp"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <utility>

#include <fmt/format.h>

#include <accdec/files/process.hpp>
#include <accdec/files/temporaries.hpp>

namespace accdec::cli {

TimeLimit::TimeLimit(double seconds, std::string last_words, int exit_code)
    : watching_([this, seconds, words = std::move(last_words), exit_code] {
        constexpr double longest = 1e9;  // s; a clock's range ends near 1e10
        std::unique_lock lock(mutex_);
        const std::chrono::duration<double> time(std::min(seconds, longest));
        if (ending_.wait_for(lock, time, [this] { return ended_; })) return;
        fmt::print(stderr, "{}\n", words);
        std::fflush(stdout);
        remove_temporaries();
        kill_running_process();
        std::_Exit(exit_code);
      }) {}

TimeLimit::~TimeLimit() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  ending_.notify_all();
  watching_.join();
}

}  // namespace accdec::cli
