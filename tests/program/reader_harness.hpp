#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <accdec/gcode/move_sink.hpp>
#include <accdec/gcode/read_error.hpp>
#include <accdec/simulate.hpp>

namespace accdec {

struct Recorder : MoveSink {
  ProgramPoint start{};
  std::vector<Move> moves;
  std::vector<double> dwells;
  void begin(const ProgramPoint& at) override { start = at; }
  void move(const Move& m) override { moves.push_back(m); }
  void stop(double dwell) override { dwells.push_back(dwell); }
};

inline Recorder read(std::string_view text, const std::string& name = "part.ngc", ReadOptions options = {}) {
  LineSource source(name, text);
  Recorder recorder;
  read_program(source, options, recorder);
  return recorder;
}

inline void expect_error(std::string_view text, const std::string& where, const std::string& what,
                         const std::string& name = "part.ngc") {
  try {
    read(text, name);
    FAIL() << "accepted: " << text;
  } catch (const ReadError& error) {
    EXPECT_THAT(error.what(), testing::StartsWith(name + ":" + where + ": ")) << text;
    EXPECT_THAT(error.what(), testing::HasSubstr(what)) << text;
  }
}

}  // namespace accdec
