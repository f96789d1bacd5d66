#include <cstdlib>

#include <fmt/format.h>

#include <accdec/study/shards.hpp>

namespace accdec::study {

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

}  // namespace accdec::study
