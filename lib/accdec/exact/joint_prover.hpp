#pragma once

#include <accdec/exact/joint.hpp>

namespace accdec::exact {

/// Proves lemmas with linear programs of its own, so its results depend only on its own earlier questions.
struct Joint::Prover {
  Prover(const Task& task, const std::function<bool()>& stop, const Window& window, int number)
      : number(number), some(task, stop, BoxKind::together), any(task, stop, BoxKind::window) {
    any.look_through(window);
  }
  Search& of(bool wide) { return wide ? any : some; }
  const Search& of(bool wide) const { return wide ? any : some; }
  long linear_programs() const { return some.linear_programs() + any.linear_programs(); }

  int number;
  Search some, any;  ///< for filters up to an order, and for filters of any order
};

}  // namespace accdec::exact
