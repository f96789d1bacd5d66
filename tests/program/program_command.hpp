#pragma once

#include <string>

#include <gtest/gtest.h>

#include "support/paths.hpp"
#include "support/process.hpp"
#include "support/temporary_folder.hpp"

namespace accdec::test {

struct Output {
  int code;
  std::string out, err;
};

/// `accdec program` in a folder with a small task.
class ProgramCommand : public ::testing::Test {
 protected:
  void SetUp() override {
    write("task.toml",
          "sample_period_ms = 1.0\n[filter]\nkind = \"trapezoid\"\norder = 40\nramp = 10\n"
          "[[axis]]\nvelocity_max_mm_s = 500\nacceleration_max_mm_s2 = 6000\njerk_max_mm_s3 = 500000\n"
          "[program]\nerror_max_um = 20\n");
  }

  void write(const std::string& name, const std::string& text) { folder_.write(name, text); }
  std::string read(const std::string& name) const { return folder_.read(name); }
  Output run(const std::string& arguments) const {
    const std::string line = "cd '" + folder_.path("") + "' && '" + test_support::program() + "' " + arguments;
    const int code = test_support::wait_for(test_support::start_shell(line, folder_.path("out"), folder_.path("err")));
    return {code, read("out"), read("err")};
  }
  /// A number of a JSON result, by the first key of this name.
  double number_of(const std::string& name, const std::string& key) const {
    const std::string text = read(name), quoted = "\"" + key + "\": ";
    return std::stod(text.substr(text.find(quoted) + quoted.size()));
  }
  const TemporaryFolder folder_;
};

}  // namespace accdec::test
