#pragma once

#include <functional>
#include <utility>

#include <coin/ClpEventHandler.hpp>

namespace accdec::exact {

/// Ends a linear program (status 5) between two iterations when `stop` returns true. A single large program can take
/// longer than the whole time limit.
class StopHandler : public ClpEventHandler {
 public:
  explicit StopHandler(std::function<bool()> stop) : stop_(std::move(stop)) {}
  int event(Event which) override { return which == endOfIteration && ++count_ % 32 == 0 && stop_() ? 0 : -1; }
  ClpEventHandler* clone() const override { return new StopHandler(*this); }

 private:
  std::function<bool()> stop_;
  int count_ = 0;
};

}  // namespace accdec::exact
