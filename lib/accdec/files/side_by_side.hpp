#pragma once

#include <cstddef>
#include <functional>

namespace accdec {

/// work(0) .. work(count - 1), on at most so many threads, this one among them. Returns when all are done.
/// @throws what the first of them threw, in the order of their numbers
void side_by_side(std::size_t count, int threads, const std::function<void(std::size_t)>& work);

}  // namespace accdec
