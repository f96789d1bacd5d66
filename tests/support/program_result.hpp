#pragma once

#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "support/run.hpp"

namespace accdec {

using Json = nlohmann::ordered_json;

/// A program of legs, an arc, a dwell and an exact stop, planned and verified by the command line.
class ProgramResult : public ::testing::Test {
 protected:
  void SetUp() override {
    program_ = folder_.write("part.ngc",
                             "G21 G90 G64 P0.02\nF6000\nG1 X30 Y0\nX30 Y20 (up)\nG3 X20 Y30 I-10 J0\nG1 X0\nG4 P0.05\n"
                             "G61.1 G1 X0 Y10\nG64 P0.05\nX10 Y0\nX0 Y0\nM2\n");
    task_ =
        folder_.write("mill.toml",
                      "sample_period_ms = 1.0\n[filter]\nkind = \"trapezoid\"\norder = 40\nramp = 12\n[[axis]]\nname = "
                      "\"x\"\nvelocity_max_mm_s = 200\nacceleration_max_mm_s2 = 3000\njerk_max_mm_s3 = "
                      "300000\n[[axis]]\nname = \"y\"\nvelocity_max_mm_s = 200\nacceleration_max_mm_s2 = "
                      "3000\njerk_max_mm_s3 = 300000\n");
    result_ = folder_.path("result.json");
  }
  Outcome plan(std::vector<std::string> more = {}) {
    std::vector<std::string> arguments{"program", program_, "--task", task_, "--json", result_};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  }
  Outcome verify() { return run({"verify", result_}); }
  Json json() const { return Json::parse(folder_.read("result.json")); }
  /// The answer of verify to a result that was changed.
  Outcome changed(const Json& json) {
    folder_.write("result.json", json.dump(1));
    return verify();
  }

  TemporaryFolder folder_;
  std::string program_, task_, result_;
};

/// Pointers to every number, word and truth value of a JSON value.
inline void leaves(const Json& json, const Json::json_pointer& at, std::vector<Json::json_pointer>& all) {
  if (json.is_object()) {
    for (const auto& [key, value] : json.items()) leaves(value, at / key, all);
  } else if (json.is_array()) {
    for (std::size_t i = 0; i < json.size(); ++i) leaves(json[i], at / i, all);
  } else {
    all.push_back(at);
  }
}

/// Another value of the same type, by more than rounding.
inline Json forged(const Json& value) {
  if (value.is_boolean()) return !value.get<bool>();
  if (value.is_number_integer()) return value.get<long>() + 100'000;  // a sample beside may use a limit alike
  if (value.is_number()) return value.get<double>() == 0.0 ? 1e-3 : value.get<double>() * (1.0 + 1e-3);
  return value.is_string() ? Json(value.get<std::string>() + "x") : Json(1.0);
}

}  // namespace accdec
