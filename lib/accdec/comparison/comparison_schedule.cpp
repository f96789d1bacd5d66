#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include <accdec/batch/shards.hpp>
#include <accdec/comparison/comparison_data.hpp>
#include <accdec/comparison/comparison_schedule.hpp>

namespace accdec::comparison {
namespace {

namespace fs = std::filesystem;

template <class Wanted>
std::vector<std::size_t> missing(const Comparison& comparison, const Entries& entries, const std::vector<bool>& cases,
                                 std::size_t from, std::size_t to, Wanted wanted) {
  std::vector<std::size_t> indices;
  for (std::size_t i = from; i < to; ++i) {
    if (entries.contains(i)) continue;
    const ScheduledRun run = comparison.at(i);
    if (cases[run.case_index] && wanted(run)) indices.push_back(i);
  }
  return indices;
}

}  // namespace

std::vector<std::size_t> next_entries(const Comparison& comparison, const Entries& entries,
                                      const std::vector<bool>& cases) {
  const std::size_t references = comparison.cases().size(), first = references + comparison.per_repeat();
  const auto always = [](const ScheduledRun&) { return true; };
  for (const auto& [from, to] : {std::pair(std::size_t{0}, references), std::pair(references, first)}) {
    std::vector<std::size_t> stage = missing(comparison, entries, cases, from, to, always);
    if (!stage.empty()) return stage;
  }
  if (comparison.size() == first) return {};
  std::vector<std::string> lines{comparison.header().dump()};
  for (const auto& [index, entry] : entries) lines.push_back(entry.row);
  const ComparisonData so_far = read_comparison(lines);
  return missing(comparison, entries, cases, first, comparison.size(), [&](const ScheduledRun& run) {
    return so_far.worth_repeating(run.case_index, run.start, run.solver);
  });
}

std::size_t open_entries(const Comparison& comparison, const Entries& entries, const std::vector<bool>& cases,
                         const std::vector<std::size_t>& next) {
  const std::size_t first = comparison.cases().size() + comparison.per_repeat();
  if (next.empty() || next.front() >= first) return next.size();
  const auto always = [](const ScheduledRun&) { return true; };
  return missing(comparison, entries, cases, 0, comparison.size(), always).size();
}

std::vector<bool> cases_of_shard(std::size_t cases, std::size_t number, std::size_t count) {
  std::vector<bool> mine(cases);
  for (const std::size_t c : batch::shard(cases, number, count)) mine[c] = true;
  return mine;
}

std::string comparison_identity(const Comparison& comparison, const std::string& hash) {
  return fmt::format("comparison {} {}", hash, comparison.size());
}

Entries shard_entries(const std::vector<std::string>& folders, const std::string& identity) {
  Entries all;
  for (const std::string& folder : folders) {
    if (!fs::is_directory(folder)) throw OutputError(fmt::format("{}: no folder to merge", folder));
    for (const auto& item : fs::directory_iterator(folder)) {
      const std::string name = item.path().filename().string();
      if (batch::shard_count(name) > 0) all.merge(batch::read_journal(item.path().string(), identity));
    }
  }
  return all;
}

std::vector<batch::ShardState> comparison_shards(const Suite& suite, const std::string& folder,
                                                 std::size_t shards) try {
  const Comparison comparison(suite.settings, suite.cases);
  std::vector<batch::ShardState> states(shards);
  for (std::size_t s = 0; s < shards; ++s) {
    batch::ShardState& state = states[s];
    state.number = s + 1;
    const std::string path = (fs::path(folder) / batch::shard_journal(s + 1, shards)).string();
    const std::vector<bool> cases = cases_of_shard(suite.cases.size(), s + 1, shards);
    Entries entries;
    if (fs::exists(path)) {
      state.in_use = batch::journal_in_use(path);
      entries = batch::read_journal(path, comparison_identity(comparison, suite.hash));
    }
    for (const auto& [index, entry] : entries) state.seconds += entry.seconds;
    state.done = entries.size();
    const std::vector<std::size_t> next = next_entries(comparison, entries, cases);
    state.points = state.done + open_entries(comparison, entries, cases, next);
  }
  return states;
} catch (const batch::JournalError& error) {
  throw OutputError(error.what());
}

}  // namespace accdec::comparison
