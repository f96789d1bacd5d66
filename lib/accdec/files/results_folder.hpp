#pragma once

#include <string>

namespace accdec {

/// A kind of results in a folder, recognised by its manifest.json.
struct ResultsKind {
  std::string schema;    ///< of the manifest
  std::string hash_key;  ///< manifest entry that names the study or suite
  std::string what;      ///< "study", "suite"
  std::string begins{};  ///< the entry begins with this; then a manifest needs no schema
};

/// Hash that a folder's manifest names; empty without a manifest, "?" for one of another kind.
std::string results_hash(const std::string& folder, const ResultsKind& kind);

/// Claims a folder for these results before anything in it is changed. A missing or empty folder gets a marker,
/// accdec-folder.json, with the schema and the hash. A folder with this marker, or with a manifest that has both, is
/// kept. Any other is refused.
/// @param changed  results of the same kind with another hash are taken over, because the caller uses them again
/// @throws OutputError
void claim_results_folder(const std::string& folder, const ResultsKind& kind, const std::string& hash,
                          bool changed = false);

/// Refuses a folder that holds anything but results of this kind. They are recognised by their manifest, which is
/// written first. It is for results that are written all at once and replace older ones of any origin. A folder that
/// does not exist is not made here; one that could not be made is refused.
/// @throws OutputError
void require_results_folder(const std::string& folder, const ResultsKind& kind);

/// Makes a folder for results and its parents, unless it exists. @throws OutputError
void create_results_folder(const std::string& folder);

}  // namespace accdec
