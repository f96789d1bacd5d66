#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include <accdec/batch/journal.hpp>
#include <accdec/batch/shards.hpp>
#include <accdec/comparison/comparison_run.hpp>
#include <accdec/comparison/suite_file.hpp>

namespace accdec::comparison {

using Entries = std::map<std::size_t, batch::Entry>;  ///< lines of the raw data by their place in the schedule

/// The entries of some cases to compute next: first their references, then the first repeats, then the other repeats
/// that are worth it. Empty when all are done.
/// @param cases  one per case of the comparison: whether it counts
std::vector<std::size_t> next_entries(const Comparison& comparison, const Entries& entries,
                                      const std::vector<bool>& cases);

/// Upper bound on the number of entries still to compute for some cases, including those from next_entries. Repeats
/// count until it is known that they are not worth it.
std::size_t open_entries(const Comparison& comparison, const Entries& entries, const std::vector<bool>& cases,
                         const std::vector<std::size_t>& next);

/// The cases of a shard. All runs of a case are in one shard, so that one machine times all solvers on it. With a
/// single shard, all cases.
std::vector<bool> cases_of_shard(std::size_t cases, std::size_t number, std::size_t count);

/// The identity of such a journal.
std::string comparison_identity(const Comparison& comparison, const std::string& hash);

/// Lines of cases from all shards' journals in some folders.
/// @throws OutputError for a folder that does not exist, JournalError
Entries shard_entries(const std::vector<std::string>& folders, const std::string& identity);

/// Progress of the shards of a comparison in a folder, in entries. @throws @throws OutputError
std::vector<batch::ShardState> comparison_shards(const Suite& suite, const std::string& folder, std::size_t shards);

}  // namespace accdec::comparison
