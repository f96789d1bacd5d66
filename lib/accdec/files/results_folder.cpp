#include <filesystem>
#include <fstream>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <accdec/files.hpp>
#include <accdec/files/output_files.hpp>
#include <accdec/files/results_folder.hpp>
#include <accdec/files/temporaries.hpp>

namespace accdec {

namespace fs = std::filesystem;

namespace {

/// The study or suite that a manifest or marker names; empty if the file is missing, "?" if it is of another kind.
std::string hash_in(const fs::path& path, const ResultsKind& kind) {
  if (!fs::exists(path)) return "";
  std::ifstream in(path, std::ios::binary);
  const auto json = nlohmann::json::parse(in, nullptr, false);
  if (!json.is_object() || !json.contains(kind.hash_key) || !json[kind.hash_key].is_string()) return "?";
  const bool schema = json.contains("schema") ? json["schema"] == kind.schema : !kind.begins.empty();
  const auto hash = json[kind.hash_key].get<std::string>();
  return schema && hash.starts_with(kind.begins) ? hash : "?";
}

constexpr const char* marker_name = "accdec-folder.json";

/// The owner of a folder by its marker; empty without one, "?" if the marker is of another kind.
std::string marked_hash(const fs::path& folder, const ResultsKind& kind) {
  return hash_in(folder / marker_name, kind);
}

/// Whether a folder holds anything except the remains of an interrupted marker.
bool holds_anything(const fs::path& folder) {
  for (const auto& item : fs::directory_iterator(folder)) {
    const std::string name = item.path().filename().string();
    if (!(name.starts_with(marker_name) && name.ends_with(".part"))) return true;
  }
  return false;
}

OutputError no_results_of(const std::string& folder, const ResultsKind& kind) {
  return OutputError(
      fmt::format("{}: is not empty and holds no {}; nothing was changed. Choose another --out (folders of results "
                  "are told by their {})",
                  folder, kind.what, kind.begins.empty() ? marker_name : "manifest.json"));
}

void require_folder(const std::string& path) {
  if (!fs::is_directory(path)) throw OutputError(fmt::format("{}: not a folder", path));
}

/// Makes a folder and removes it again, with the parents that it needed.
void require_creatable(const std::string& folder) {
  if (folder.empty()) throw OutputError("the name of the folder for results is empty; give the name of a folder");
  std::vector<fs::path> missing;
  for (fs::path at = fs::absolute(folder).lexically_normal(); !at.empty() && !fs::exists(at); at = at.parent_path())
    missing.push_back(at);
  create_results_folder(folder);
  std::error_code ignored;
  for (const fs::path& made : missing) fs::remove(made, ignored);
}

}  // namespace

std::string results_hash(const std::string& folder, const ResultsKind& kind) {
  return hash_in(fs::path(folder) / "manifest.json", kind);
}

void claim_results_folder(const std::string& folder, const ResultsKind& kind, const std::string& hash, bool changed) {
  if (fs::exists(folder)) {
    require_folder(folder);
    const std::string finished = results_hash(folder, kind), marked = marked_hash(folder, kind);
    // The marker is newer than the manifest: results are replaced when the new ones are complete.
    const std::string& owner = marked.empty() ? finished : marked;
    const bool foreign = finished == "?" || marked == "?";
    if (foreign || !(owner.empty() || owner == hash || changed)) {
      throw OutputError(
          fmt::format("{}: holds the results of another {}, or of an earlier form of this one; nothing was changed. "
                      "Choose another --out, or {}",
                      folder, kind.what, foreign ? "remove the folder" : "replace them with --fresh"));
    }
    if (!marked.empty() && marked == hash) return;
    if (finished.empty() && marked.empty() && holds_anything(folder)) throw no_results_of(folder, kind);
  }
  create_results_folder(folder);
  nlohmann::ordered_json marker;
  marker["schema"] = kind.schema;
  marker[kind.hash_key] = hash;
  marker["note"] =
      fmt::format("accdec keeps the results of this {} here and replaces them; keep nothing else here", kind.what);
  write_file((fs::path(folder) / marker_name).string(), marker.dump(2) + "\n");
}

void require_results_folder(const std::string& folder, const ResultsKind& kind) {
  if (!fs::exists(folder)) return require_creatable(folder);
  require_folder(folder);
  const std::string finished = results_hash(folder, kind);
  remove_remains(folder);
  const bool foreign = finished == "?" || fs::exists(fs::path(folder) / marker_name);
  if (foreign || (finished.empty() && holds_anything(folder))) throw no_results_of(folder, kind);
}

void create_results_folder(const std::string& folder) {
  std::error_code failure;
  fs::create_directories(folder, failure);
  if (failure) throw OutputError(fmt::format("{}: cannot be created: {}", folder, failure.message()));
}

}  // namespace accdec
