#pragma once

#include <stdexcept>

#include <accdec/task/task.hpp>

namespace accdec::exact {

/// The linear programs of a search would not fit into the memory there is, or their pivots would take longer than
/// anybody waits. The words are for the user.
class TooLarge : public std::length_error {
  using std::length_error::length_error;
};

/// About what the dense tableau of one linear program and its rows take, in bytes, while it grows: an estimate from
/// above that is right to a factor of two.
double linear_program_bytes(const Task& task, int order);

/// To be called before a linear program is built. @throws TooLarge
void require_room(const Task& task, int order);

}  // namespace accdec::exact
