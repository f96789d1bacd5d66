#pragma once

#include <algorithm>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>

#include <accdec/result.hpp>

namespace accdec::explore {

/// The last results of every place that asks, whole and with their proofs: a page asks about them by number.
class Held {
 public:
  using Result = std::shared_ptr<const DesignResult>;

  /// @param place  of the page and slot that ask: an answer may come while the page still shows the one before
  /// @returns its number, from 1 on
  std::size_t keep(std::string_view place, DesignResult result) {
    constexpr std::ptrdiff_t most_of_place = 2;
    constexpr std::size_t most = 64;
    const auto here = [&](const One& one) { return one.place == place; };
    const std::lock_guard lock(mutex_);
    if (std::count_if(results_.begin(), results_.end(), here) == most_of_place)
      results_.erase(std::find_if(results_.begin(), results_.end(), here));
    if (results_.size() == most) results_.pop_front();
    results_.push_back({++last_, std::string(place), std::make_shared<const DesignResult>(std::move(result))});
    return last_;
  }
  /// Null if there is no such result any more.
  Result find(std::size_t number) const {
    const std::lock_guard lock(mutex_);
    const auto found =
        std::find_if(results_.begin(), results_.end(), [&](const One& one) { return one.number == number; });
    return found == results_.end() ? nullptr : found->result;
  }

 private:
  struct One {
    std::size_t number;
    std::string place;
    Result result;
  };
  mutable std::mutex mutex_;
  std::deque<One> results_;
  std::size_t last_ = 0;
};

}  // namespace accdec::explore
