#pragma once

#include <string>

namespace accdec::test_support {

/// The folder of the sources, for problems/ and results/.
const std::string& source_folder();
/// The command-line program of this build.
const std::string& program();

}  // namespace accdec::test_support
