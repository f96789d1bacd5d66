#pragma once

#include <string>
#include <vector>

#include <accdec/comparison/comparison_schedule.hpp>

namespace accdec {

/// Raw data: one JSON object per line.
inline constexpr const char* comparison_raw_name = "raw.jsonl";
/// Lines of earlier forms of a suite that the present form does not use; they are used again if a later form needs
/// them.
inline constexpr const char* comparison_earlier_name = "earlier.jsonl";
inline constexpr const char* comparison_journal_name = "comparison.journal";

/// The entries in a folder that its suite, or any earlier form of it, has finished.
struct EarlierEntries {
  comparison::Entries entries;      ///< by their place in the present comparison
  std::vector<std::string> others;  ///< lines without a place in it
  batch::Row session;               ///< how the last session's time was spent; null without one
  bool unknown = false;             ///< some lines cannot be placed, because it is unknown what they depend on
};

/// An entry is used if everything it depends on is unchanged (Comparison::key), at whatever place the suite has it now.
/// Lines without a key, from older versions, are used if `same_suite` says that nothing has changed.
/// @throws batch::JournalError for a journal that cannot be read
EarlierEntries earlier_entries(const std::string& folder, const comparison::Comparison& comparison, bool same_suite);

/// Those of the suite's own journal that are used.
comparison::Entries placed_entries(const comparison::Entries& entries, const comparison::Comparison& comparison);

/// Whole lines of a text, empty ones left out.
std::vector<std::string> lines_of(const std::string& text);

}  // namespace accdec
