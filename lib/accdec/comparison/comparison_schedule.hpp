#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include <accdec/comparison/comparison_run.hpp>
#include <accdec/comparison/suite_file.hpp>
#include <accdec/study/journal.hpp>
#include <accdec/study/shards.hpp>

namespace accdec::comparison {

using Entries = std::map<std::size_t, study::Entry>;  ///< lines of the raw data by their place in the schedule

/// What is to be computed next of some cases: their references; when these are there the first repeats; and then those
/// other repeats that are worth it. Empty when all is there.
/// @param cases  one of each case of the comparison: whether it counts
std::vector<std::size_t> next_entries(const Comparison& comparison, const Entries& entries,
                                      const std::vector<bool>& cases);

/// How many entries of some cases are still to be computed at most, what next_entries gave included: repeats count
/// until it is known that they are not worth it.
std::size_t open_entries(const Comparison& comparison, const Entries& entries, const std::vector<bool>& cases,
                         const std::vector<std::size_t>& next);

/// The cases of a shard. All runs of a case are in one shard, so that one machine times all solvers on it. All cases of
/// the only shard.
std::vector<bool> cases_of_shard(std::size_t cases, std::size_t number, std::size_t count);

/// What such a journal is begun for.
std::string comparison_identity(const Comparison& comparison, const std::string& hash);

/// Lines that belong to cases, of all shards' journals in some folders.
/// @throws OutputError for a folder that does not exist, JournalError
Entries shard_entries(const std::vector<std::string>& folders, const std::string& identity);

/// How far the shards of a comparison in a folder are, in entries. @throws OutputError
std::vector<study::ShardState> comparison_shards(const Suite& suite, const std::string& folder, std::size_t shards);

}  // namespace accdec::comparison
