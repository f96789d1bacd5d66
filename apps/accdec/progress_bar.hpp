#pragma once

#include <memory>

#include <accdec/study/study_folder.hpp>

#include "status_line.hpp"

namespace accdec::cli {

/// Time so far, points done, rate and remaining time on standard error. On terminals in one line, rewritten every
/// second and at most ten times a second; elsewhere a line after ten seconds and then every minute.
class ProgressBar {
 public:
  explicit ProgressBar(const char* unit = "points");
  void operator()(const batch::Progress& p);

 private:
  const char* unit_;
  bool terminal_;
  double shown_ = -1.0;
  std::shared_ptr<StatusLine> line_;  // the bar is copied into a std::function
};

}  // namespace accdec::cli
