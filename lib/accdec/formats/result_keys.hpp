#pragma once

#include <accdec/files/keys.hpp>

namespace accdec {

/// Every member of a result file, SI units in the names.
const FileKind& result_file();

}  // namespace accdec
