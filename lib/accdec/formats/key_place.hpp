#pragma once

#include <string>

#include <accdec/files.hpp>
#include <accdec/files/refused_key.hpp>

namespace accdec {

/// The refusal at the first place of a task file that has its key, in whichever table. If there are several keys,
/// the first that the file has counts; if it has none, there is no place.
InputError error_at_key(const std::string& task, const RefusedKey& refused);

}  // namespace accdec
