#pragma once

#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <system_error>

namespace accdec {

/// A folder of this user alone (mode 0700) in the folder for temporaries. It is there as long as this is.
class ScratchFolder {
 public:
  /// @throws std::runtime_error if none can be made
  explicit ScratchFolder(const std::string& prefix) {
    std::error_code missing;
    std::string name = (std::filesystem::temp_directory_path(missing) / (prefix + "-XXXXXX")).string();
    if (missing || ::mkdtemp(name.data()) == nullptr)
      throw std::runtime_error("no temporary folder can be made; TMPDIR must name a folder that can be written to");
    path_ = name;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  std::string string() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

}  // namespace accdec
