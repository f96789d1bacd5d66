#include <algorithm>
#include <fstream>
#include <limits>
#include <string>

#include <sys/resource.h>
#include <unistd.h>

#include <accdec/files/memory.hpp>

namespace accdec {
namespace {

constexpr double unknown = std::numeric_limits<double>::infinity();

double system_available() {
  std::ifstream in("/proc/meminfo");
  for (std::string key, unit; in >> key;) {
    double kilobytes = 0.0;
    if (key == "MemAvailable:" && in >> kilobytes) return 1024.0 * kilobytes;
    std::getline(in, unit);
  }
  return unknown;
}

/// The number that a file holds; "max" or a missing file means no limit.
double number_in(const char* path) {
  std::ifstream in(path);
  double value = 0.0;
  return in >> value ? value : unknown;
}

double group_available() {
  const double most = number_in("/sys/fs/cgroup/memory.max"), used = number_in("/sys/fs/cgroup/memory.current");
  return most < unknown && used < unknown ? std::max(0.0, most - used) : unknown;
}

double address_space_left() {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return unknown;
  const double pages = number_in("/proc/self/statm");
  const double used = pages < unknown ? pages * static_cast<double>(sysconf(_SC_PAGESIZE)) : 0.0;
  return std::max(0.0, static_cast<double>(limit.rlim_cur) - used);
}

}  // namespace

double available_memory() {
  return std::min({system_available(), group_available(), address_space_left()});
}

}  // namespace accdec
