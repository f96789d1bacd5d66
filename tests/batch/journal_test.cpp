#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>
#include <thread>

#include <gmock/gmock.h>

#include <accdec/batch/journal.hpp>

namespace accdec::batch {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

std::string fresh_path(const std::string& name) {
  const std::string path = ::testing::TempDir() + "accdec_journal_" + name;
  std::filesystem::remove(path);
  return path;
}
std::string content(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}
void set_content(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

TEST(Journal, KeepsWhatWasAppended) {
  const std::string path = fresh_path("keep");
  {
    Journal journal(path, "s1");
    EXPECT_TRUE(journal.entries().empty());
    journal.append(5, {0.25, R"({"a":1})"});
    journal.append(2, {1e-7, R"({"a":"x y"})"});
  }
  Journal again(path, "s1");
  ASSERT_EQ(again.entries().size(), 2u);
  EXPECT_EQ(again.entries().at(5).row, R"({"a":1})");
  EXPECT_EQ(again.entries().at(2).row, R"({"a":"x y"})");
  EXPECT_EQ(again.entries().at(5).seconds, 0.25);
}

TEST(Journal, CutAtAnyByteItLosesOnlyTheTornLine) {
  const std::string path = fresh_path("cut");
  {
    Journal journal(path, "study");
    for (std::size_t i = 0; i < 4; ++i) journal.append(i, {0.5, R"({"value":123})"});
  }
  const std::string whole = content(path);
  for (std::size_t bytes = 0; bytes <= whole.size(); ++bytes) {
    set_content(path, whole.substr(0, bytes));
    const auto lines =
        static_cast<std::size_t>(std::count(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(bytes), '\n'));
    Journal journal(path, "study");
    ASSERT_EQ(journal.entries().size(), lines == 0 ? 0 : lines - 1) << bytes;
    journal.append(9, {0.5, R"({"value":9})"});
    EXPECT_EQ(read_journal(path, "study").at(9).row, R"({"value":9})");
  }
}

TEST(Journal, WhatStandsBeforeANewBeginningIsVoid) {
  const std::string path = fresh_path("anew");
  {
    Journal journal(path, "s");
    journal.append(1, {0.5, R"({"old":1})"});
    EXPECT_FALSE(journal.fresh());
    journal.begin_fresh();
    EXPECT_TRUE(journal.fresh());
    EXPECT_TRUE(journal.entries().empty());
    journal.append(2, {0.5, R"({"new":2})"});
  }
  {
    Journal again(path, "s");
    EXPECT_TRUE(again.fresh());
    ASSERT_EQ(again.entries().size(), 1u);
    EXPECT_EQ(again.entries().at(2).row, R"({"new":2})");
  }
  EXPECT_EQ(read_journal(path, "s").count(1), 0u);
  // A mark torn by a kill is cut off: that run had not begun.
  const std::string whole = content(path);
  set_content(path, whole.substr(0, whole.find("anew\n") + 4));
  Journal torn(path, "s");
  EXPECT_FALSE(torn.fresh());
  EXPECT_EQ(torn.entries().count(1), 1u);
}

TEST(Journal, RefusesOtherStudiesAndOtherFilesAndLeavesThemAlone) {
  const std::string path = fresh_path("other");
  { Journal journal(path, "s1"); }
  const std::string before = content(path);
  EXPECT_THAT([&] { Journal(path, "s2"); }, ThrowsMessage<JournalError>(HasSubstr("another study")));
  EXPECT_EQ(content(path), before);
  set_content(path, "my notes\n");
  EXPECT_THAT([&] { Journal(path, "s1"); }, ThrowsMessage<JournalError>(HasSubstr("not a study's journal")));
  EXPECT_EQ(content(path), "my notes\n");
  EXPECT_THROW(read_journal(fresh_path("none"), "s1"), JournalError);
}

TEST(Journal, OneWriterAtATime) {
  const std::string path = fresh_path("lock");
  Journal first(path, "s");
  EXPECT_THAT([&] { Journal(path, "s"); }, ThrowsMessage<JournalError>(HasSubstr("in use")));
}

// A run that finishes removes its journal; whoever waited for the lock must not go on with a file without a name.
TEST(Journal, WaitedForUntilItWasRemovedIsSaidToHaveBeenInUse) {
  const std::string path = fresh_path("ended");
  const auto opened = [&] {
    std::size_t count = 0;
    for (const auto& link : std::filesystem::directory_iterator("/proc/self/fd")) {
      std::error_code closed;
      count += std::filesystem::read_symlink(link, closed) == path ? 1U : 0U;
    }
    return count;
  };
  auto first = std::make_unique<Journal>(path, "s");
  ASSERT_EQ(opened(), 1U);
  std::string said;
  std::thread second([&] {
    try {
      Journal(path, "s");
    } catch (const JournalError& error) {
      said = error.what();
    }
  });
  while (opened() < 2) std::this_thread::yield();
  std::filesystem::remove(path);
  first.reset();
  second.join();
  EXPECT_THAT(said, ::testing::AnyOf(HasSubstr("was in use by another accdec study"), HasSubstr(": in use by")));
  EXPECT_FALSE(std::filesystem::exists(path));
}

}  // namespace
}  // namespace accdec::batch
