#pragma once

#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <string>

namespace accdec::explore {

/// Questions that are being answered, by page and kind.
class Computing {
 public:
  static constexpr std::size_t most = 8;  ///< at a time
  using Flag = std::shared_ptr<std::atomic<bool>>;
  /// Cancels what computes there. Null if there is too much to do already.
  Flag enter(const std::string& place) {
    const std::lock_guard lock(mutex_);
    if (const auto before = flags_.find(place); before != flags_.end()) before->second->store(true);
    if (ended_ || count_ >= most) return nullptr;
    ++count_;
    return flags_[place] = std::make_shared<std::atomic<bool>>(false);
  }
  void leave(const std::string& place, const Flag& flag) {
    const std::lock_guard lock(mutex_);
    --count_;
    if (const auto now = flags_.find(place); now != flags_.end() && now->second == flag) flags_.erase(now);
  }
  /// Cancels what computes for this page in this slot, whatever the question.
  void cancel(const std::string& client, const std::string& slot) {
    const std::lock_guard lock(mutex_);
    for (const auto& [place, flag] : flags_) {
      if (place.compare(0, client.size() + 1, client + "\n") == 0 && place.size() > slot.size() &&
          place.compare(place.size() - slot.size() - 1, std::string::npos, "\n" + slot) == 0)
        flag->store(true);
    }
  }
  void end() {
    const std::lock_guard lock(mutex_);
    ended_ = true;
    for (const auto& [place, flag] : flags_) flag->store(true);
  }

 private:
  std::mutex mutex_;
  std::map<std::string, Flag> flags_;
  std::size_t count_ = 0;
  bool ended_ = false;
};

}  // namespace accdec::explore
