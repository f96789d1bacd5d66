#pragma once

namespace accdec {

/// The least number above `low` that holds, by halving. `low` does not hold and `high` does; neither is asked. If a
/// number holds, all up to `high` do; otherwise the answer is some number that holds behind one that does not.
template <class Holds>
int least_held(int low, int high, const Holds& holds) {
  while (high - low > 1) {
    const int middle = low + (high - low) / 2;
    (holds(middle) ? high : low) = middle;
  }
  return high;
}

}  // namespace accdec
