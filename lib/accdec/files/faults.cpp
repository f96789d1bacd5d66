#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include <accdec/files/faults.hpp>

namespace accdec {

InputErrors::InputErrors(std::vector<InputError> all, std::size_t unlisted, bool at_least)
    : InputError(all.front()), all_(std::move(all)), unlisted_(unlisted), at_least_(at_least) {
  constexpr std::size_t shown = 10;
  const std::size_t n = std::min(all_.size(), shown);
  for (std::size_t i = 0; i < n; ++i) lines_ += (i == 0 ? "" : "\n") + std::string(all_[i].what());
  if (const std::size_t others = all_.size() - n + unlisted_; others > 0)
    lines_ += fmt::format("\n{}: and {}{} more", file(), at_least_ ? "at least " : "", others);
}

void sort_by_position(std::vector<InputError>& errors) {
  std::stable_sort(errors.begin(), errors.end(), [](const InputError& a, const InputError& b) {
    return std::pair(a.line(), a.column()) < std::pair(b.line(), b.column());
  });
}

bool Faults::none_below(const std::string& pointer) const {
  return std::none_of(list_.begin(), list_.end(), [&](const InputError& error) {
    const std::string& at = error.pointer();
    return at.starts_with(pointer) && (at.size() == pointer.size() || at[pointer.size()] == '/');
  });
}

void Faults::raise() {
  if (list_.empty()) return;
  sort_by_position(list_);
  const bool at_least = full();
  throw InputErrors(std::move(list_), 0, at_least);
}

}  // namespace accdec
