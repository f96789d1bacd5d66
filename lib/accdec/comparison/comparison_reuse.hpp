#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include <accdec/comparison/comparison_run.hpp>
#include <accdec/study/journal.hpp>

namespace accdec {

/// Raw data: one JSON object a line.
inline constexpr const char* comparison_raw_name = "raw.jsonl";
/// Lines of earlier forms of a suite that the present one does not ask for; found again if one does.
inline constexpr const char* comparison_earlier_name = "earlier.jsonl";
inline constexpr const char* comparison_journal_name = "comparison.journal";

/// What a folder holds of a comparison: entries that its suite, or any earlier form of it, has finished.
struct EarlierEntries {
  std::map<std::size_t, study::Entry> entries;  ///< by their place in the comparison as it is now
  std::vector<std::string> others;              ///< lines it has no place for
  study::Row session;                           ///< how the time of the last session was spent; null without one
  bool unknown = false;                         ///< some lines cannot be placed: nobody knows what they depend on
};

/// An entry counts if everything it depends on is as it was (Comparison::key), wherever the suite has it now; lines
/// without a key, of older versions, count if `same_suite` says that nothing at all has changed.
/// @throws study::JournalError for a journal that cannot be read
EarlierEntries earlier_entries(const std::string& folder, const comparison::Comparison& comparison, bool same_suite);

/// Whole lines of a text, empty ones left out.
std::vector<std::string> lines_of(const std::string& text);

}  // namespace accdec
