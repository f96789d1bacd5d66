#include "support/paths.hpp"

#include "test_paths.hpp"

namespace accdec::test_support {

// The only file that knows them, so that every other object is the same wherever the sources lie.
const std::string& source_folder() {
  static const std::string folder = ACCDEC_SOURCE_DIR;
  return folder;
}

const std::string& program() {
  static const std::string path = ACCDEC_BINARY;
  return path;
}

}  // namespace accdec::test_support
