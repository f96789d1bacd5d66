#pragma once

#include <memory>
#include <ostream>
#include <string>
#include <string_view>

namespace accdec {

/// One output, written whole or not at all: into a temporary of a random name beside its target, opened exclusively and
/// never through a link, flushed to the disk, then renamed over the target. An existing file stays as it was until
/// `commit`, and for good if anything fails; its permissions are kept.
///
/// What a name stands for is the same for every output of every command:
///   "-", /dev/stdout      standard output
///   a pipe or a device    written directly, for replacing it would reach nobody who listens
///   a symbolic link       the file it leads to is replaced (or made), the link stays
///   a hard link           this name gets the new file, its other names keep the old one
class OutputFile {
 public:
  /// Opens it. @throws OutputError naming the path, as all members do
  explicit OutputFile(const std::string& path);
  OutputFile(OutputFile&&) noexcept;
  /// Removes the temporary unless it was committed.
  ~OutputFile();

  void write(std::string_view text);
  /// The same as a stream; what it could not write is told by `close`.
  std::ostream& stream();
  /// All that was written is on the disk (or with whoever reads the pipe).
  void close();
  /// Gives the file its name. Closes first if that was not done.
  void commit();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Whether a name stands for standard output.
bool is_standard_output(const std::string& path);
/// Whether a name stands for a pipe or a device.
bool is_special_file(const std::string& path);

/// Where a name leads through symbolic links, whether anything is there or not.
std::string link_target(const std::string& path);

}  // namespace accdec
