#include <algorithm>
#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <accdec/batch/journal.hpp>
#include <accdec/files/json_position.hpp>
#include <accdec/study/row_store.hpp>

namespace accdec::study {

using batch::JournalError;

namespace {

/// Whether the member `point` of a row is this word.
bool point_is(std::string_view row, std::string_view word) {
  const std::string_view value = row.substr(locate(row, "/point"));
  return value.starts_with(fmt::format("\"{}\"", word));
}

}  // namespace

bool is_lost(std::string_view row) {
  return point_is(row, "lost");
}

RowStore::~RowStore() {
  for (const File& file : files_) {
    if (file.data) ::munmap(const_cast<char*>(file.data), file.mapped);
  }
}

std::size_t RowStore::add_file(const std::string& path) {
  if (files_.size() > UINT16_MAX) throw JournalError(fmt::format("{}: more than {} files of rows", path, UINT16_MAX));
  files_.push_back({path});
  return files_.size() - 1;
}

void RowStore::put(std::size_t index, std::size_t file, std::uint64_t offset, std::string_view row) {
  if (index >= places_.size() || !row.starts_with(fmt::format(R"({{"index":{},)", index)) || row.size() > UINT32_MAX ||
      !nlohmann::json::accept(row))
    return;
  Place place{offset, static_cast<std::uint32_t>(row.size()), static_cast<std::uint16_t>(file), is_lost(row),
              point_is(row, "ok")};
  if (place.lost && has(index) && !places_[index].lost) return;
  places_[index] = place;
}

void RowStore::clear(std::size_t file) {
  for (Place& place : places_) {
    if (place.file == file) place = {};
  }
}

void RowStore::drop_lost() {
  for (Place& place : places_) {
    if (place.lost) place = {};
  }
}

void RowStore::map(File& file, std::size_t least) {
  if (file.data) ::munmap(const_cast<char*>(file.data), file.mapped);
  file.data = nullptr;
  const int descriptor = ::open(file.path.c_str(), O_RDONLY | O_CLOEXEC);
  struct stat about {};
  const bool there = descriptor >= 0 && ::fstat(descriptor, &about) == 0;
  file.mapped = there ? static_cast<std::size_t>(about.st_size) : 0;
  void* const data =
      file.mapped >= least ? ::mmap(nullptr, file.mapped, PROT_READ, MAP_SHARED, descriptor, 0) : MAP_FAILED;
  const int reason = errno;
  if (descriptor >= 0) ::close(descriptor);
  if (data == MAP_FAILED) throw JournalError(fmt::format("{}: cannot be read: {}", file.path, std::strerror(reason)));
  file.data = static_cast<const char*>(data);
}

std::string_view RowStore::row(std::size_t index) {
  const Place& place = places_[index];
  File& file = files_[place.file];
  const std::size_t end = place.offset + place.length;
  if (end > file.mapped || !file.data) map(file, end);
  return {file.data + place.offset, place.length};
}

std::size_t RowStore::count() const {
  return static_cast<std::size_t>(
      std::count_if(places_.begin(), places_.end(), [](const Place& p) { return p.length > 0; }));
}

std::size_t RowStore::count_lost() const {
  return static_cast<std::size_t>(std::count_if(places_.begin(), places_.end(), [](const Place& p) { return p.lost; }));
}

std::size_t RowStore::count_unanswered() const {
  return static_cast<std::size_t>(
      std::count_if(places_.begin(), places_.end(), [](const Place& p) { return p.length > 0 && !p.answered; }));
}

}  // namespace accdec::study
