#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace accdec {

/// Writes a whole file or nothing: into PATH.part beside the target, flushed to the disk, then renamed over it. An
/// existing file stays as it was until the rename, and for good if anything fails. "-" is standard output; pipes and
/// devices are simply written to.
/// @throws OutputError naming the path.
void write_file(const std::string& path, std::string_view content);

/// Several output files of one command, written all or none: `commit` first writes every file's .part, and only when
/// all are on the disk renames them. What goes to "-" comes last.
class OutputFiles {
 public:
  OutputFiles() = default;
  OutputFiles(const OutputFiles&) = delete;
  OutputFiles& operator=(const OutputFiles&) = delete;

  /// Adds one; an existing file is replaced. @throws OutputError if a path is given twice.
  void add(const std::string& path, std::string content);
  /// @throws OutputError naming the path that failed; then no file has been changed.
  void commit();

 private:
  std::vector<std::pair<std::string, std::string>> files_;
};

/// Throws OutputError unless a file could be created at `path` now ("-" always can): lets a command refuse before long
/// work.
void require_writable(const std::string& path);

}  // namespace accdec
