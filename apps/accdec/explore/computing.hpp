#pragma once

#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include <accdec/files.hpp>

namespace accdec::explore {

/// Questions that are being answered, by page and kind.
class Computing {
 public:
  static constexpr std::size_t most = 12;  ///< at a time
  using Flag = std::shared_ptr<std::atomic<bool>>;
  /// Cancels what computes there. Null if there is too much to do already.
  /// @param seconds  after which `cancel_late` cancels it
  /// @param gone     whether nobody waits for the answer any more: `cancel_late` asks that, until the question leaves
  Flag enter(const std::string& place, double seconds, std::function<bool()> gone) {
    const std::lock_guard lock(mutex_);
    if (const auto before = questions_.find(place); before != questions_.end()) before->second.flag->store(true);
    if (ended_ || count_ >= most) return nullptr;
    ++count_;
    const auto flag = std::make_shared<std::atomic<bool>>(false);
    questions_[place] = {flag, Deadline(seconds), std::move(gone)};
    return flag;
  }
  void leave(const std::string& place, const Flag& flag) {
    const std::lock_guard lock(mutex_);
    --count_;
    if (const auto now = questions_.find(place); now != questions_.end() && now->second.flag == flag)
      questions_.erase(now);
  }
  void cancel_late() {
    const std::lock_guard lock(mutex_);
    for (const auto& [place, question] : questions_) {
      if (question.until.over() || question.gone()) question.flag->store(true);
    }
  }
  /// Cancels what computes for this page in this slot, whatever the question.
  void cancel(const std::string& client, const std::string& slot) {
    const std::lock_guard lock(mutex_);
    for (const auto& [place, question] : questions_) {
      if (place.compare(0, client.size() + 1, client + "\n") == 0 && place.size() > slot.size() &&
          place.compare(place.size() - slot.size() - 1, std::string::npos, "\n" + slot) == 0)
        question.flag->store(true);
    }
  }
  void end() {
    const std::lock_guard lock(mutex_);
    ended_ = true;
    for (const auto& [place, question] : questions_) question.flag->store(true);
  }

 private:
  struct Question {
    Flag flag;
    Deadline until;
    std::function<bool()> gone;
  };
  std::mutex mutex_;
  std::map<std::string, Question> questions_;
  std::size_t count_ = 0;
  bool ended_ = false;
};

}  // namespace accdec::explore
