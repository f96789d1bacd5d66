#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <accdec/files/atomic_file.hpp>
#include <accdec/files/errors.hpp>
#include <accdec/files/results_folder.hpp>

namespace accdec {

namespace fs = std::filesystem;

std::string results_hash(const std::string& folder, const ResultsKind& kind) {
  const fs::path path = fs::path(folder) / "manifest.json";
  if (!fs::exists(path)) return "";
  std::ifstream in(path, std::ios::binary);
  const auto json = nlohmann::json::parse(in, nullptr, false);
  const bool ours = json.is_object() && json.value("schema", "") == kind.schema && json.contains(kind.hash_key) &&
                    json[kind.hash_key].is_string();
  return ours ? json[kind.hash_key].get<std::string>() : "?";
}

void check_results_folder(const std::string& folder, const ResultsKind& kind, const std::string& hash) {
  if (!fs::exists(folder)) return;
  if (!fs::is_directory(folder)) throw OutputError(fmt::format("{}: not a folder", folder));
  const std::string found = results_hash(folder, kind);
  if (!found.empty() && found != hash) {
    throw OutputError(
        fmt::format("{}: holds the results of another {}, or of an earlier form of this one; nothing was changed. "
                    "Choose another --out or remove it",
                    folder, kind.what));
  }
  bool journal = false, other = false;
  for (const auto& item : fs::directory_iterator(folder)) {
    journal = journal || item.path().extension() == ".journal";
    other = other || item.path().extension() != ".journal";
  }
  if (found.empty() && other && !journal) {
    throw OutputError(
        fmt::format("{}: is not empty and holds no {}; nothing was changed. Choose another --out", folder, kind.what));
  }
}

void create_results_folder(const std::string& folder) {
  std::error_code failure;
  fs::create_directories(folder, failure);
  if (failure) throw OutputError(fmt::format("{}: cannot be created: {}", folder, failure.message()));
}

}  // namespace accdec
