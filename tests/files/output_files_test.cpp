#include <csignal>
#include <filesystem>
#include <functional>
#include <thread>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <accdec/files.hpp>
#include <accdec/files/output_files.hpp>
#include <accdec/files/results_folder.hpp>
#include <accdec/files/temporaries.hpp>

#include "support/temporary_folder.hpp"

namespace accdec {
namespace {

using ::testing::HasSubstr;

std::string failure_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const OutputError& error) {
    return error.what();
  }
  return "";
}

TEST(OutputFiles, WritesAndReplacesLeavingNothingElse) {
  TemporaryFolder folder;
  write_file(folder.path("a"), "one");
  write_file(folder.path("a"), std::string("two\0three", 9));
  EXPECT_EQ(folder.read("a"), std::string("two\0three", 9));
  EXPECT_EQ(folder.count(), 1U);
}

// A killed process leaves its temporary; the next one to write into the folder removes it, and no living one's.
TEST(OutputFiles, TemporariesOfDeadProcessesAreRemoved) {
  const TemporaryFolder folder;
  std::string own;
  const int file = open_temporary(folder.path("own"), own);
  ASSERT_GE(file, 0);
  const pid_t child = ::fork();
  if (child == 0) {
    std::string name;
    ::_exit(open_temporary(folder.path("report.html"), name) >= 0 ? 0 : 1);
  }
  // It has ended, and this process did not ask for its status yet.
  siginfo_t ended{};
  ASSERT_EQ(::waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOWAIT), 0);
  ASSERT_EQ(ended.si_status, 0);
  folder.write("notes.part", "mine");
  ASSERT_EQ(folder.count(), 3U) << "own, the child's, notes";
  // Another process, for which the folder is new.
  const pid_t next = ::fork();
  if (next == 0) {
    const std::string there = folder.path("") + "/./r.json";
    write_file(there, "{}");
    ::_exit(0);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(next, &status, 0), next);
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_EQ(folder.count(), 3U) << "own, notes, r.json";
  EXPECT_EQ(folder.read("r.json"), "{}");
  EXPECT_TRUE(std::filesystem::exists(own));
  EXPECT_EQ(folder.read("notes.part"), "mine");
  ::close(file);
  remove_temporary(own);
}

// As many as the instances of a large suite.
TEST(OutputFiles, ASignalRemovesThousandsOfTemporaries) {
  const TemporaryFolder folder;
  const pid_t child = ::fork();
  if (child == 0) {
    remove_temporaries_on_signals();
    for (int i = 0; i < 2000; ++i) {
      std::string name;
      ::close(open_temporary(folder.path(std::to_string(i)), name));
    }
    std::raise(SIGTERM);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(folder.count(), 0U);
}

// An interrupted run leaves nothing in the way of the next one.
TEST(OutputFiles, AFolderWithTemporariesOfDeadProcessesIsTakenAsEmpty) {
  const TemporaryFolder folder;
  const pid_t child = ::fork();
  if (child == 0) {
    std::string name;
    ::_exit(open_temporary(folder.path("instance.nl"), name) >= 0 ? 0 : 1);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_EQ(folder.count(), 1U);
  require_results_folder(folder.path(""), {"test/1", "command", "tests"});
  EXPECT_EQ(folder.count(), 0U);
}

TEST(OutputFiles, PermissionsOfAnExistingFileStay) {
  TemporaryFolder folder;
  folder.write("a", "old");
  ::chmod(folder.path("a").c_str(), 0640);
  write_file(folder.path("a"), "new");
  EXPECT_EQ(std::filesystem::status(folder.path("a")).permissions(), std::filesystem::perms(0640));
}

TEST(OutputFiles, WhatCannotBeWrittenIsNamed) {
  TemporaryFolder folder;
  const std::string path = folder.path("none/a");
  EXPECT_THAT(failure_of([&] { write_file(path, "x"); }), HasSubstr(path));
  EXPECT_THAT(failure_of([&] { require_outputs({path}, {}); }), HasSubstr(path));
  EXPECT_THAT(failure_of([&] { write_file(folder.path(""), "x"); }), HasSubstr("is a directory"));
  EXPECT_THAT(failure_of([&] { write_file("", "x"); }), HasSubstr("empty"));
  EXPECT_EQ(folder.count(), 0U);
}

TEST(OutputFiles, UnwritableFolder) {
  if (::geteuid() == 0) GTEST_SKIP() << "permissions do not bind the superuser";
  TemporaryFolder folder;
  folder.write("a", "old");
  ::chmod(folder.path("").c_str(), 0500);
  EXPECT_THAT(failure_of([&] { write_file(folder.path("a"), "new"); }), HasSubstr("Permission denied"));
  ::chmod(folder.path("").c_str(), 0700);
  EXPECT_EQ(folder.read("a"), "old");
  EXPECT_EQ(folder.count(), 1U);
}

TEST(OutputFiles, FullDiskKeepsTheOldFileAndLeavesNothing) {
  if (::access("/dev/full", W_OK) == 0) {
    EXPECT_THAT(failure_of([&] { write_file("/dev/full", "x"); }), HasSubstr("/dev/full"));
  }
  TemporaryFolder folder;
  folder.write("a", "old");
  // A limit on the size of files stands for a full disk; beyond it a write fails like one, in a process of its own.
  const pid_t child = ::fork();
  if (child == 0) {
    const rlimit small{100, 100};
    ::setrlimit(RLIMIT_FSIZE, &small);
    std::signal(SIGXFSZ, SIG_IGN);
    ::_exit(failure_of([&] { write_file(folder.path("a"), std::string(1000, 'x')); }).empty() ? 1 : 0);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
  EXPECT_EQ(folder.read("a"), "old");
  EXPECT_EQ(folder.count(), 1U);
}

TEST(OutputFiles, SeveralAreWrittenAllOrNone) {
  TemporaryFolder folder;
  folder.write("a", "old");
  OutputFiles files;
  files.add(folder.path("a"), "new");
  files.add(folder.path("b"), "new");
  files.add(folder.path("none/c"), "new");
  EXPECT_THAT(failure_of([&] { files.commit(); }), HasSubstr("none/c"));
  EXPECT_EQ(folder.read("a"), "old");
  EXPECT_EQ(folder.count(), 1U);

  OutputFiles good;
  good.add(folder.path("a"), "new");
  good.add(folder.path("b"), "too");
  EXPECT_THAT(failure_of([&] { good.add(folder.path("a"), "twice"); }), HasSubstr("two outputs"));
  good.commit();
  EXPECT_EQ(folder.read("a"), "new");
  EXPECT_EQ(folder.read("b"), "too");
  EXPECT_EQ(folder.count(), 2U);
}

TEST(OutputFiles, LinksAndDevicesSurvive) {
  TemporaryFolder folder;
  folder.write("target", "old");
  std::filesystem::create_symlink(folder.path("target"), folder.path("link"));
  write_file(folder.path("link"), "new");
  EXPECT_TRUE(std::filesystem::is_symlink(folder.path("link")));
  EXPECT_EQ(folder.read("target"), "new");
  // A hard link is another name of the old file and keeps it.
  std::filesystem::create_hard_link(folder.path("target"), folder.path("other"));
  write_file(folder.path("target"), "newer");
  EXPECT_EQ(folder.read("other"), "new");
  write_file("/dev/null", "x");
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
}

TEST(OutputFiles, ALinkThatLeadsToItselfIsNoPlaceToWriteTo) {
  TemporaryFolder folder;
  std::filesystem::create_symlink("b", folder.path("a"));
  std::filesystem::create_symlink("a", folder.path("b"));
  EXPECT_THAT(failure_of([&] { write_file(folder.path("a"), "text"); }), HasSubstr("cannot be written"));
  EXPECT_TRUE(std::filesystem::is_symlink(folder.path("a")));
  EXPECT_EQ(folder.count(), 2U);
}

TEST(OutputFiles, AnInputThatStandardOutputGoesToIsRefused) {
  TemporaryFolder folder;
  write_file(folder.path("task"), "text");
  std::fflush(stdout);
  const int before = ::dup(STDOUT_FILENO), file = ::open(folder.path("task").c_str(), O_WRONLY | O_APPEND);
  ASSERT_GE(::dup2(file, STDOUT_FILENO), 0);
  const std::string refusal = failure_of([&] { require_outputs({""}, {folder.path("task")}); });
  ::dup2(before, STDOUT_FILENO);
  ::close(before), ::close(file);
  EXPECT_THAT(refusal, HasSubstr("is an input, and standard output goes there"));
  EXPECT_EQ(folder.read("task"), "text");
}

TEST(OutputFiles, LinksLaidWhereATemporaryWasForeseenAreNotFollowed) {
  TemporaryFolder folder;
  folder.write("victim", "precious");
  std::filesystem::create_symlink(folder.path("victim"), folder.path("a.part"));
  write_file(folder.path("a"), "new");
  EXPECT_EQ(folder.read("victim"), "precious");
  EXPECT_EQ(folder.read("a"), "new");
}

TEST(OutputFiles, AreNoInputsAndNoOtherOutputs) {
  TemporaryFolder folder;
  folder.write("task", "input");
  std::filesystem::create_symlink(folder.path("task"), folder.path("soft"));
  std::filesystem::create_hard_link(folder.path("task"), folder.path("hard"));
  for (const char* name : {"task", "./task", "soft", "hard"}) {
    EXPECT_THAT(failure_of([&] { require_outputs({folder.path(name)}, {folder.path("task")}); }),
                HasSubstr("is an input"))
        << name;
  }
  EXPECT_THAT(failure_of([&] {
                require_outputs({folder.path("soft"), folder.path("hard")}, {});
              }),
              HasSubstr("two outputs"));
  EXPECT_THAT(failure_of([&] {
                require_outputs({folder.path("new"), folder.path("./new")}, {});
              }),
              HasSubstr("two outputs"));
  std::filesystem::create_symlink(folder.path("new"), folder.path("to-new"));
  EXPECT_THAT(failure_of([&] {
                require_outputs({folder.path("new"), folder.path("to-new")}, {});
              }),
              HasSubstr("two outputs"));
  EXPECT_THAT(failure_of([&] { require_outputs({"-", "/dev/stdout"}, {}); }), HasSubstr("two outputs"));
  EXPECT_EQ(failure_of([&] {
              require_outputs({folder.path("x"), "", "-", "/dev/null", "/dev/null"}, {folder.path("task"), ""});
            }),
            "");
  EXPECT_EQ(folder.read("task"), "input");
  EXPECT_EQ(folder.count(), 4U);
}

TEST(OutputFiles, ManyWritersOfOneFileDoNotMeet) {
  TemporaryFolder folder;
  std::vector<std::thread> writers;
  for (char c = 'a'; c < 'i'; ++c) {
    writers.emplace_back([&, c] {
      for (int i = 0; i < 20; ++i) write_file(folder.path("raced"), std::string(10000, c));
    });
  }
  for (std::thread& writer : writers) writer.join();
  const std::string text = folder.read("raced");
  EXPECT_EQ(text, std::string(10000, text.front()));
  EXPECT_EQ(folder.count(), 1U);
}

TEST(OutputFiles, SignalsRemoveTemporaries) {
  TemporaryFolder folder;
  const pid_t child = ::fork();
  if (child == 0) {
    remove_temporaries_on_signals();
    OutputFile file(folder.path("a"));
    file.write("half");
    ::raise(SIGTERM);
    ::_exit(0);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGTERM);
  EXPECT_EQ(folder.count(), 0U);
}

}  // namespace
}  // namespace accdec
