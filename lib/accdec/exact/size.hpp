#pragma once

#include <stdexcept>

#include <accdec/task.hpp>

namespace accdec::exact {

/// The linear programs of a search would not fit into memory, or their pivots would take too long. The text is for the
/// user.
class TooLarge : public std::length_error {
  using std::length_error::length_error;
};

/// Estimate of the memory in bytes that the dense tableau of one linear program and its rows take. It is an upper
/// estimate, right to a factor of two.
double linear_program_bytes(const Task& task, int order);

/// Call before a linear program is built. @throws TooLarge
void require_room(const Task& task, int order);

}  // namespace accdec::exact
