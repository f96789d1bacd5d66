#include <cstdlib>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include <accdec/comparison/external_solver.hpp>

#include "compare_command.hpp"

// The words of a command, and the files among them.

namespace accdec {
namespace {

using ::testing::HasSubstr;

TEST(ExternalCommandWords, QuotesGroupAndPlacesAreFilled) {
  using Words = std::vector<std::string>;
  const std::map<std::string, std::string> places{{"nl", "/a b/{answer}"}, {"answer", "out"}};
  EXPECT_EQ(comparison::command_words(" x  {nl}\t-o={answer} ", places), (Words{"x", "/a b/{answer}", "-o=out"}));
  EXPECT_EQ(comparison::command_words("sh -c 'm \"{nl}\" > {answer}' '' \"it's\"", places),
            (Words{"sh", "-c", "m \"/a b/{answer}\" > out", "", "it's"}));
  EXPECT_EQ(comparison::command_words("awk '{{print}}'", places), (Words{"awk", "{print}"}));
  for (const char* bad : {"x {foo}", "x {answer", "x }", "x {", "x {}", "x {nl {answer}", "x 'a", "x \"a' {nl}"}) {
    EXPECT_THROW(comparison::command_words(bad, places), std::invalid_argument) << bad;
  }
}

using ProgramState = testing::CompareCommand;

// An outsider changes his program, and installs one that was missing.
TEST_F(ProgramState, AnswersOfAnOtherProgramAreComputedAgain) {
  const std::string path = (home_ / "later").string();
  testing::write(home_ / "suite.toml", R"(title = "Mini"
starts = 1
repeats = 1
time_limit_s = 5
[[external]]
name = "script"
command = "sh {suite}/script.sh {nl} {answer}"
reads = "nl"
answer = "values"
[[external]]
name = "later"
command = ")" + path + R"( {nl} {answer}"
reads = "nl"
answer = "values"
[[problem]]
name = "corner"
task = ")" + test_support::source_folder() +
                                           R"(/problems/corner/acceleration-jerk.toml"
formulation = "margin"
order = 30
)");
  const auto script = [&](const char* name, const std::string& claim) {
    testing::write(home_ / name, "#!/bin/sh\necho " + claim + " > \"$2\"\n");
    std::filesystem::permissions(home_ / name, std::filesystem::perms::owner_all);
  };
  script("script.sh", "infeasible");
  const auto compared = [&] { return run("compare suite.toml --out out").output; };
  EXPECT_THAT(compared(), HasSubstr(": 3 entries computed"));
  EXPECT_THAT(compared(), HasSubstr(": 0 entries computed"));
  script("script.sh", "failed");
  EXPECT_THAT(compared(), HasSubstr(": 1 entries computed"));
  script("later", "failed");
  EXPECT_THAT(compared(), HasSubstr(": 1 entries computed"));
}

// A program is seen in a command of the shell, behind =, and as a folder that Python runs.
TEST_F(ProgramState, ProgramsAreSeenWhereverACommandNamesThem) {
  std::filesystem::create_directories(home_ / "a folder/more");
  testing::write(home_ / "a folder/__main__.py", "import more");
  const auto state = [&](const std::string& command) {
    return comparison::program_state({"mine", command, "nl", "sol", home_.string()});
  };
  const struct {
    const char *command, *file;
  } programs[] = {{"sh -c 'cd /tmp; {suite}/solver {nl} > {answer}'", "solver"},
                  {"julia --run={suite}/solver {nl}", "solver"},
                  {"sh -c '\"{suite}/solver\" {nl}'", "solver"},
                  {"python3 '{suite}/a folder' {nl}", "a folder/__main__.py"},
                  {"python3 '{suite}/a folder' {nl}", "a folder/more/steps.py"},
                  {"sh -c 'python3 \"{suite}/a folder/x=y.py\" {nl}'", "a folder/x=y.py"},
                  {"sh -c 'python3 {suite}/a\\ folder/x=y.py {nl}'", "a folder/x=y.py"},
                  {"sh -c 'PYTHONPATH={suite}/x=y.py python3 {nl}'", "x=y.py"},
                  {"sh -c 'my_solver {nl} > {answer}'", "my_solver"}};
  const std::string path = std::getenv("PATH");
  ::setenv("PATH", (home_.string() + ":" + path).c_str(), 1);
  for (const auto& [command, file] : programs) {
    std::filesystem::remove(home_ / file);
    std::set<std::string> states{state(command)};
    for (const char* content : {"one", "other"}) {
      testing::write(home_ / file, content);
      std::filesystem::permissions(home_ / file, std::filesystem::perms::owner_all);
      states.insert(state(command));
    }
    EXPECT_EQ(states.size(), 3u) << command;
    std::filesystem::create_directories(home_ / "a folder/__pycache__");
    testing::write(home_ / "a folder/__pycache__/steps.pyc", file);
    EXPECT_TRUE(states.contains(state(command))) << command;
  }
  ::setenv("PATH", path.c_str(), 1);
}

}  // namespace
}  // namespace accdec
