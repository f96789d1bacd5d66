#pragma once

#include <string>

namespace accdec {

/// A kind of results that a folder can hold, told by its manifest.json.
struct ResultsKind {
  std::string schema;    ///< of the manifest
  std::string hash_key;  ///< manifest entry that says which study or suite it is
  std::string what;      ///< "study", "suite"
  std::string begins{};  ///< the entry begins with this; then a manifest needs no schema
};

/// Hash that a folder's manifest names; empty without a manifest, "?" for one of another kind.
std::string results_hash(const std::string& folder, const ResultsKind& kind);

/// Makes a folder these results' own before anything in it is touched: one that is not there or empty gets a marker,
/// accdec-folder.json, with the schema and the hash; one that has the marker, or a manifest with both, is kept; any
/// other is refused.
/// @param changed  results of the same kind with another hash are taken over, for the caller uses them again
/// @throws OutputError
void claim_results_folder(const std::string& folder, const ResultsKind& kind, const std::string& hash,
                          bool changed = false);

/// Refuses a folder that holds anything but results of this kind: told by their manifest, which is written before them.
/// For results that are written all at once and replace those there whatever they were made of.
/// @throws OutputError
void require_results_folder(const std::string& folder, const ResultsKind& kind);

/// Makes a folder for results, with those it lies in, unless it is there already. @throws OutputError
void create_results_folder(const std::string& folder);

}  // namespace accdec
