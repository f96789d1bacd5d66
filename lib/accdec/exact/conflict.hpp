#pragma once

#include <functional>
#include <string>

#include <accdec/task/task.hpp>

namespace accdec::exact {

/// Of a task that is infeasible: a minimal set of its limits in conflict (any one of them away, the rest can be held),
/// in words. Found by leaving out limits one at a time; if stopped, the set is still in conflict, but perhaps not
/// minimal.
std::string conflict_message(const Task& task, const std::function<bool()>& stop);

}  // namespace accdec::exact
