#pragma once

#include <functional>
#include <string>
#include <vector>

#include <accdec/task/task.hpp>

namespace accdec::exact {

/// Of a task that is infeasible: a minimal set of its limits in conflict (any one of them away, the rest can be held),
/// in words. Found by leaving out limits one at a time.
struct Conflict {
  std::vector<std::string> limits;
  bool minimal = true;  ///< false: stopped; the set is still in conflict, but perhaps not all of it
};
Conflict find_conflict(const Task& task, const std::function<bool()>& stop);
std::string to_message(const Conflict& conflict, const Task& task);

}  // namespace accdec::exact
