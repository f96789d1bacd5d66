#include <accdec/io/manifest.hpp>

#include <ctime>
#include <fstream>
#include <thread>

#include <sys/utsname.h>
#include <unistd.h>

#include <coin/ClpConfig.h>
#include <Eigen/Core>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <oneapi/tbb/version.h>

namespace accdec {
namespace {

std::string processor() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("model name")) return line.substr(std::min(line.find(": ") + 2, line.size()));
  }
  return "unknown";
}

}  // namespace

void add_environment(nlohmann::ordered_json& manifest, const std::string& version) {
  utsname system{};
  ::uname(&system);
  const double memory = static_cast<double>(::sysconf(_SC_PHYS_PAGES)) * static_cast<double>(::sysconf(_SC_PAGE_SIZE)) / 0x1p30;
  manifest["accdec"] = version;
  manifest["libraries"] = {{"Clp", CLP_VERSION},
                           {"Eigen", fmt::format("{}.{}.{}", EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION)},
                           {"oneTBB", fmt::format("{}.{}", TBB_VERSION_MAJOR, TBB_VERSION_MINOR)}};
  manifest["compiler"] = __VERSION__;
#ifdef NDEBUG
  manifest["build"] = "optimised, without assertions";
#else
  manifest["build"] = "with assertions";
#endif
  manifest["machine"] = {{"processor", processor()},
                         {"cores", std::thread::hardware_concurrency()},
                         {"memory_GiB", static_cast<int>(memory + 0.5)},
                         {"system", fmt::format("{} {} {}", system.sysname, system.release, system.machine)}};
  manifest["finished"] = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
}

}  // namespace accdec
