#pragma once

#include <memory>

#include <accdec/study/study_folder.hpp>

#include "status_line.hpp"

namespace accdec::cli {

/// Time so far, points done, rate and remaining time in one line on standard error, rewritten every second and at most
/// ten times a second. For terminals.
class ProgressBar {
 public:
  explicit ProgressBar(const char* unit = "points");
  void operator()(const StudyProgress& p);

 private:
  const char* unit_;
  double shown_ = -1.0;
  std::shared_ptr<StatusLine> line_;  // the bar is copied into a std::function
};

}  // namespace accdec::cli
