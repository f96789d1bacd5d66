#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <accdec/files/output_file.hpp>

namespace accdec {

/// Writes a whole file or nothing, as `OutputFile` describes. @throws OutputError naming the path
void write_file(const std::string& path, std::string_view content);

/// Several outputs of one command: all are written or none. `commit` first writes every file beside its target. Only
/// when all are on the disk it gives them their names. Standard output, pipes and devices come last.
class OutputFiles {
 public:
  OutputFiles() = default;
  OutputFiles(const OutputFiles&) = delete;
  OutputFiles& operator=(const OutputFiles&) = delete;

  /// Adds one; an existing file is replaced. @throws OutputError if a file is given twice
  void add(const std::string& path, std::string content);
  /// @throws OutputError naming the path that failed; then no file has been changed
  void commit();

 private:
  std::vector<std::pair<std::string, std::string>> files_;
};

/// Call at the beginning of a command, before it computes. Throws OutputError unless every output can be written now
/// and differs from all inputs and other outputs. Also throws if standard output goes to an input. Files themselves are
/// compared, not their names, so links and other spellings are found. Empty names stand for outputs that are not
/// wanted.
void require_outputs(const std::vector<std::string>& outputs, const std::vector<std::string>& inputs);

/// Whether two names lead to the same file, existing or not.
bool same_file(const std::string& a, const std::string& b);

}  // namespace accdec
