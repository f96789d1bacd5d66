#pragma once

#include <string>
#include <vector>

#include <toml++/toml.h>

#include <accdec/formats/task_edit.hpp>
#include <accdec/study/study_file.hpp>

// Internal to this folder: the data that a Study keeps of its base tasks.

namespace accdec {

struct Study::Tasks {
  struct Source {
    std::string path;
    toml::table tree;  ///< the case's own settings already in it
  };
  std::vector<Source> cases;               ///< one per case of the plan
  std::vector<std::vector<TaskKey>> keys;  ///< one list per variation
};

}  // namespace accdec
