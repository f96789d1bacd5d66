#pragma once

#include <cstddef>
#include <functional>

namespace accdec {

/// Calls work(0) .. work(count - 1) on at most this many threads, including the calling one. Returns when all are done.
/// @throws the exception of the call with the lowest number that threw
void side_by_side(std::size_t count, int threads, const std::function<void(std::size_t)>& work);

}  // namespace accdec
