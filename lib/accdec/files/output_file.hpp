#pragma once

#include <memory>
#include <ostream>
#include <string>
#include <string_view>

namespace accdec {

/// One output, written completely or not at all. It is written to a temporary with a random name beside its target,
/// opened exclusively and never through a link. The temporary is flushed to the disk and then renamed to the target. An
/// existing file stays unchanged until `commit`, and for good if anything fails. Its permissions are kept.
///
/// A name means the same for every output of every command:
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
  /// The same as a stream; `close` reports what could not be written.
  std::ostream& stream();
  /// Makes sure that all data is on the disk, or with the reader of the pipe.
  void close();
  /// Gives the file its name; calls `close` first if needed.
  void commit();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Whether a name stands for standard output.
bool is_standard_output(const std::string& path);
/// Whether a name stands for a pipe or a device.
bool is_special_file(const std::string& path);

/// The path a name leads to through symbolic links, whether the file exists or not.
std::string link_target(const std::string& path);

}  // namespace accdec
