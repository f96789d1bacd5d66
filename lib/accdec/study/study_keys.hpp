#pragma once

#include <accdec/files/keys.hpp>

namespace accdec {

/// Every key of a study file.
const FileKind& study_file();

}  // namespace accdec
