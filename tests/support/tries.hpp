#pragma once

namespace accdec::test_support {

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define ACCDEC_UNDER_SANITIZERS 1
#endif
#endif

/// How many cases of a random test are tried: all of `n`, and under sanitizers a quarter. Those watch the code, not its
/// answers, and each case takes them ten times as long.
constexpr int tries(int n) {
#ifdef ACCDEC_UNDER_SANITIZERS
  return (n + 3) / 4;
#else
  return n;
#endif
}

}  // namespace accdec::test_support
