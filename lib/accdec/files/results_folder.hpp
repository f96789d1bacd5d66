#pragma once

#include <string>

namespace accdec {

/// A kind of results that a folder can hold, told by its manifest.json.
struct ResultsKind {
  std::string schema;    ///< of the manifest
  std::string hash_key;  ///< manifest entry that says which study or suite it is
  std::string what;      ///< "study", "suite"
};

/// Hash that a folder's manifest names; empty without a manifest, "?" for one of another kind.
std::string results_hash(const std::string& folder, const ResultsKind& kind);

/// Refuses a folder that holds anything but these results or their journal, before anything in it is touched.
/// @throws OutputError
void check_results_folder(const std::string& folder, const ResultsKind& kind, const std::string& hash);

/// Makes a folder for results, with those it lies in, unless it is there already. @throws OutputError
void create_results_folder(const std::string& folder);

}  // namespace accdec
