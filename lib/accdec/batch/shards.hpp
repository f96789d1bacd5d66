#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace accdec::batch {

/// The indices of shard `number` (1 .. count) of `size` points, ascending: of every `count` consecutive points each
/// shard gets one, drawn by a generator of fixed seed. So every shard has its part of every region and of every value
/// of each axis. Plain striping does not give this if the number of values and `count` have a common divisor. The
/// result is the same on every platform.
/// @throws std::invalid_argument unless 1 <= number <= count.
std::vector<std::size_t> shard(std::size_t size, std::size_t number, std::size_t count);
/// The shard of each point.
std::vector<std::uint32_t> shard_owners(std::size_t size, std::size_t count);

/// Progress of one shard of a study or a comparison, by its journal.
struct ShardState {
  std::size_t number = 1;            ///< 1 .. count
  std::size_t points = 0, done = 0;  ///< to compute in total, and computed
  std::size_t lost = 0;              ///< of those not done: their process died; the next run tries again
  double seconds = 0.0;              ///< spent inside the computations of finished points
  bool in_use = false;               ///< a process is appending to the journal
  bool complete() const { return done >= points; }
};

/// File name of a shard's journal.
std::string shard_journal(std::size_t number, std::size_t count);

/// N of such a name; 0 for any other.
std::size_t shard_count(const std::string& name);

/// Numbers as ranges, "1-3,7", as Slurm takes them for an array. Empty for none. @param numbers  rising
std::string ranges_text(const std::vector<std::size_t>& numbers);

/// "3/8 (no point of 12), 5/8 (7 of 12 points)": the incomplete shards.
std::string incomplete_text(const std::vector<ShardState>& shards);

}  // namespace accdec::batch
