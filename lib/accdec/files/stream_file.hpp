#pragma once

#include <fstream>
#include <ostream>
#include <string>

namespace accdec {

/// A file too large to be built in memory: written to PATH.part, which gets its name on commit and vanishes otherwise.
/// "-" is standard output.
class StreamFile {
 public:
  StreamFile() = default;
  StreamFile(const StreamFile&) = delete;
  StreamFile& operator=(const StreamFile&) = delete;
  ~StreamFile();

  /// @throws std::runtime_error naming the path, as the others do, if the file cannot be written.
  void open(const std::string& path);
  std::ostream& stream();
  /// All data on its way to the disk.
  void close();
  /// Gives the file its name; does nothing if none was opened.
  void commit();

 private:
  std::string path_, part_;
  std::ofstream file_;
};

}  // namespace accdec
