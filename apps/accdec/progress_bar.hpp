#pragma once

#include <accdec/study/study_folder.hpp>

namespace accdec::cli {

/// Points done, rate and remaining time in one line on standard error, rewritten at most ten times a second. For
/// terminals.
class ProgressBar {
 public:
  explicit ProgressBar(const char* unit = "points") : unit_(unit) {}
  void operator()(const StudyProgress& p);

 private:
  const char* unit_;
  double shown_ = -1.0;
};

}  // namespace accdec::cli
