#include <algorithm>
#include <cstdlib>
#include <random>
#include <stdexcept>

#include <fmt/format.h>

#include <accdec/batch/portable_random.hpp>
#include <accdec/batch/shards.hpp>

namespace accdec::batch {
namespace {

/// Distributes the points: what(first point, order), where order[s] + first goes to shard s + 1.
template <class What>
void deal_out(std::size_t size, std::size_t count, What what) {
  std::mt19937_64 rng(1);
  std::vector<std::size_t> deal;
  for (std::size_t from = 0; from < size; from += deal.size()) {
    deal.resize(std::min(count, size - from));  // the first shards get one each of the last few points
    shuffle(deal, rng);
    what(from, deal);
  }
}

}  // namespace

std::vector<std::size_t> shard(std::size_t size, std::size_t number, std::size_t count) {
  if (number < 1 || number > count)
    throw std::invalid_argument(
        fmt::format("shard {}/{} does not exist; allowed is 1/{} to {}/{}", number, count, count, count, count));
  std::vector<std::size_t> indices;
  deal_out(size, count, [&](std::size_t from, const std::vector<std::size_t>& deal) {
    if (number <= deal.size()) indices.push_back(from + deal[number - 1]);
  });
  return indices;
}

std::vector<std::uint32_t> shard_owners(std::size_t size, std::size_t count) {
  std::vector<std::uint32_t> owners(size);
  deal_out(size, count, [&](std::size_t from, const std::vector<std::size_t>& deal) {
    for (std::size_t s = 0; s < deal.size(); ++s) owners[from + deal[s]] = static_cast<std::uint32_t>(s + 1);
  });
  return owners;
}

std::string shard_journal(std::size_t number, std::size_t count) {
  return fmt::format("shard-{}-of-{}.journal", number, count);
}

std::size_t shard_count(const std::string& name) {
  const std::size_t of = name.find("-of-");
  if (!name.starts_with("shard-") || !name.ends_with(".journal") || of == std::string::npos) return 0;
  return std::strtoul(name.c_str() + of + 4, nullptr, 10);
}

std::string ranges_text(const std::vector<std::size_t>& numbers) {
  std::string text;
  for (std::size_t i = 0; i < numbers.size();) {
    std::size_t last = i;
    while (last + 1 < numbers.size() && numbers[last + 1] == numbers[last] + 1) ++last;
    text += fmt::format("{}{}", text.empty() ? "" : ",", numbers[i]);
    if (last > i) text += fmt::format("-{}", numbers[last]);
    i = last + 1;
  }
  return text;
}

std::string incomplete_text(const std::vector<ShardState>& shards) {
  std::string text;
  for (const ShardState& s : shards) {
    if (s.complete()) continue;
    text +=
        fmt::format("{}{}/{} ({} of {} points)", text.empty() ? "" : ", ", s.number, shards.size(), s.done, s.points);
  }
  return text;
}

}  // namespace accdec::batch
