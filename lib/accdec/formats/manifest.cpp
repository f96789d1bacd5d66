#include <cmath>
#include <ctime>
#include <fstream>
#include <map>
#include <set>
#include <thread>

#include <sys/utsname.h>
#include <unistd.h>
#include <zlib.h>

#include <Eigen/Core>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <toml++/impl/version.h>

#include <accdec/formats/manifest.hpp>
#include <accdec/solver.hpp>

#include "accdec_commit.hpp"

namespace accdec {
namespace {

std::string processor() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("model name")) return line.substr(std::min(line.find(": ") + 2, line.size()));
  }
  return "unknown";
}

/// Files of the linear algebra libraries of this process (BLAS, LAPACK, MUMPS and its orderings). Debian's alternatives
/// choose them, and large problems spend their time in them.
std::set<std::string> linear_algebra() {
  std::set<std::string> files;
  std::ifstream in("/proc/self/maps");
  for (std::string line; std::getline(in, line);) {
    const std::size_t path = line.find('/');
    if (path == std::string::npos) continue;
    const std::string file = line.substr(line.rfind('/') + 1);
    for (const char* name : {"blas", "lapack", "atlas", "mumps", "metis", "scotch"}) {
      if (file.find(name) != std::string::npos) files.insert(line.substr(path));
    }
  }
  return files;
}

}  // namespace

std::vector<std::pair<std::string, std::string>> libraries() {
  std::map<std::string, std::string> found{
      {"Eigen", fmt::format("{}.{}.{}", EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION)},
      {"fmt", fmt::format("{}.{}.{}", FMT_VERSION / 10000, FMT_VERSION / 100 % 100, FMT_VERSION % 100)},
      {"nlohmann-json",
       fmt::format("{}.{}.{}", NLOHMANN_JSON_VERSION_MAJOR, NLOHMANN_JSON_VERSION_MINOR, NLOHMANN_JSON_VERSION_PATCH)},
      {"oneTBB", ACCDEC_TBB_VERSION},
      {"zlib", ZLIB_VERSION},
      {"toml++", fmt::format("{}.{}.{}", TOML_LIB_MAJOR, TOML_LIB_MINOR, TOML_LIB_PATCH)}};
  for (const auto& [name, version] : solvers::libraries()) found.emplace(name, version);
  std::erase_if(found, [](const auto& library) { return library.second.empty(); });  // not built in
  return {found.begin(), found.end()};
}

std::string source_commit() {
  return ACCDEC_COMMIT;
}

void add_environment(nlohmann::ordered_json& manifest, const std::string& version) {
  utsname system{};
  ::uname(&system);
  const double memory =
      static_cast<double>(::sysconf(_SC_PHYS_PAGES)) * static_cast<double>(::sysconf(_SC_PAGE_SIZE)) / 0x1p30;
  manifest["accdec"] = version;
  manifest["commit"] = source_commit();
  for (const auto& [name, number] : libraries()) manifest["libraries"][name] = number;
  // At run time another version may be installed. "NLopt 2.7.1"
  for (const auto& solver : solvers::registry()) {
    const std::string library = solver->library_version();
    if (const std::size_t space = library.rfind(' '); space != std::string::npos)
      manifest["libraries"][library.substr(0, space)] = library.substr(space + 1);
  }
  manifest["linear_algebra"] = linear_algebra();
  manifest["compiler"] = __VERSION__;
#ifdef NDEBUG
  manifest["build"] = "optimised, without assertions";
#else
  manifest["build"] = "with assertions";
#endif
  manifest["machine"] = {{"processor", processor()},
                         {"cores", std::thread::hardware_concurrency()},
                         {"memory_GiB", std::lround(memory)},
                         {"system", fmt::format("{} {} {}", system.sysname, system.release, system.machine)}};
  manifest["finished"] = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
}

}  // namespace accdec
