#pragma once

#include <functional>
#include <string>
#include <vector>

#include <accdec/task.hpp>

namespace accdec::exact {

/// A minimal set of conflicting limits of an infeasible task, in words: without any one of them, the others can be
/// held. Found by leaving out limits one at a time.
struct Conflict {
  std::vector<std::string> limits;
  bool minimal = true;  ///< false: the search was stopped; the set conflicts, but a part of it may be enough
};
Conflict find_conflict(const Task& task, const std::function<bool()>& stop);
std::string to_message(const Conflict& conflict, const Task& task);

}  // namespace accdec::exact
