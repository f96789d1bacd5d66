#include <functional>

#include <sys/stat.h>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <accdec/files/atomic_file.hpp>
#include <accdec/files/errors.hpp>

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

TEST(AtomicFile, WritesAndReplacesLeavingNothingElse) {
  TemporaryFolder folder;
  write_file(folder.path("a"), "one");
  write_file(folder.path("a"), std::string("two\0three", 9));
  EXPECT_EQ(folder.read("a"), std::string("two\0three", 9));
  EXPECT_EQ(folder.count(), 1U);
}

TEST(AtomicFile, MissingFolderIsNamed) {
  TemporaryFolder folder;
  const std::string path = folder.path("none/a");
  EXPECT_THAT(failure_of([&] { write_file(path, "x"); }), HasSubstr(path));
  EXPECT_THAT(failure_of([&] { require_writable(path); }), HasSubstr(path));
  EXPECT_EQ(folder.count(), 0U);
}

TEST(AtomicFile, FolderAsTargetIsRefused) {
  TemporaryFolder folder;
  EXPECT_THAT(failure_of([&] { write_file(folder.path(""), "x"); }), HasSubstr("is a directory"));
  EXPECT_EQ(folder.count(), 0U);
}

TEST(AtomicFile, ExistingFileStaysWhenWritingFails) {
  TemporaryFolder folder;
  folder.write("a", "old");
  // The part file cannot be made where a folder has its name: works for the superuser too, unlike permissions.
  std::filesystem::create_directory(folder.path("a.part"));
  EXPECT_THAT(failure_of([&] { write_file(folder.path("a"), "new"); }), HasSubstr("a: cannot be written"));
  EXPECT_EQ(folder.read("a"), "old");
}

TEST(AtomicFile, UnwritableFolder) {
  if (::geteuid() == 0) GTEST_SKIP() << "permissions do not bind the superuser";
  TemporaryFolder folder;
  folder.write("a", "old");
  ::chmod(folder.path("").c_str(), 0500);
  EXPECT_THAT(failure_of([&] { write_file(folder.path("a"), "new"); }), HasSubstr("Permission denied"));
  ::chmod(folder.path("").c_str(), 0700);
  EXPECT_EQ(folder.read("a"), "old");
  EXPECT_EQ(folder.count(), 1U);
}

TEST(AtomicFile, FullDiskLeavesNothing) {
  if (::access("/dev/full", W_OK) != 0) GTEST_SKIP();
  EXPECT_THAT(failure_of([&] { write_file("/dev/full", "x"); }), HasSubstr("/dev/full"));
}

TEST(AtomicFile, SeveralFilesAreWrittenAllOrNone) {
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

TEST(AtomicFile, LinksAndDevicesSurvive) {
  TemporaryFolder folder;
  folder.write("target", "old");
  std::filesystem::create_symlink(folder.path("target"), folder.path("link"));
  write_file(folder.path("link"), "new");
  EXPECT_TRUE(std::filesystem::is_symlink(folder.path("link")));
  EXPECT_EQ(folder.read("target"), "new");
  write_file("/dev/null", "x");
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
}

}  // namespace
}  // namespace accdec
