#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <random>
#include <regex>
#include <set>
#include <string>
#include <system_error>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>

#include <accdec/files/temporaries.hpp>

namespace accdec {
namespace {

/// Names that a signal handler can read at any moment. If there are more temporaries at a time, the others are opened
/// but not noted.
std::array<std::atomic<char*>, 65536> noted{};

void note(const std::string& name) {
  char* const copy = ::strdup(name.c_str());
  for (auto& slot : noted) {
    char* empty = nullptr;
    if (slot.compare_exchange_strong(empty, copy)) return;
  }
  std::free(copy);
}

void forget(const std::string& name) {
  for (auto& slot : noted) {
    char* held = slot.load();
    if (held == nullptr || name != held || !slot.compare_exchange_strong(held, nullptr)) continue;
    std::free(held);
    return;
  }
}

/// Last words when a signal ends this process, and the process: children it forks inherit the handler.
std::atomic<const char*> last_words{nullptr};
std::atomic<pid_t> speaker{0};

extern "C" void remove_and_end(int signal) {
  // Only functions allowed in a handler: getpid, write, unlink, signal, raise.
  if (const char* const words = last_words.load(); words != nullptr && ::getpid() == speaker.load())
    (void)!::write(STDERR_FILENO, words, std::strlen(words));
  accdec::remove_temporaries();
  std::signal(signal, SIG_DFL);
  ::raise(signal);
}

}  // namespace

namespace {

/// The name of a host: in folders that several hosts share, only a host's own processes can be recognised as dead.
std::uint32_t host_mark() {
  std::array<char, 256> name{};
  (void)::gethostname(name.data(), name.size() - 1);
  std::uint32_t hash = 2166136261U;
  for (const char* c = name.data(); *c != '\0'; ++c) hash = (hash ^ static_cast<unsigned char>(*c)) * 16777619U;
  return hash;
}

/// The process of a temporary "NAME.hhhhhhhh.PID.rrrrrrrr.part" of this host; 0 of anything else.
pid_t owner_of(const std::string& name) {
  static const std::regex pattern(R"(.*\.([0-9a-f]{8})\.([1-9][0-9]{0,8})\.[0-9a-f]{8}\.part)", std::regex::optimize);
  std::smatch match;
  if (!name.ends_with(".part") || !std::regex_match(name, match, pattern)) return 0;
  return match[1] == fmt::format("{:08x}", host_mark()) ? std::stoi(match[2]) : 0;
}

/// Whether a process has ended. A killed one that its parent did not wait for yet still has its number.
bool ended(pid_t process) {
  if (::kill(process, 0) != 0) return errno == ESRCH;
  std::ifstream file(fmt::format("/proc/{}/stat", process));
  std::string stat;
  std::getline(file, stat);
  // "PID (NAME) STATE ..", where the name may hold anything.
  const std::size_t name_end = stat.rfind(") ");
  return name_end != std::string::npos && stat.compare(name_end + 2, 1, "Z") == 0;
}

}  // namespace

void remove_remains(const std::string& folder) {
  static std::mutex mutex;
  static std::set<std::string> done;
  const std::lock_guard lock(mutex);
  if (!done.insert(folder).second) return;
  std::error_code unreadable;
  std::filesystem::directory_iterator item(folder, unreadable);
  for (; !unreadable && item != std::filesystem::directory_iterator(); item.increment(unreadable)) {
    const pid_t owner = owner_of(item->path().filename().string());
    if (owner > 0 && ended(owner)) ::unlink(item->path().c_str());
  }
}

int open_temporary(const std::string& target, std::string& name) {
  thread_local std::random_device random;
  const std::size_t slash = target.rfind('/');
  const std::string folder = slash == std::string::npos ? "" : target.substr(0, slash + 1);
  // In most file systems a name has at most 255 bytes, and the ending must fit.
  const std::string stem = target.substr(folder.size()).substr(0, 200);
  remove_remains(folder.empty() ? "." : folder);
  for (int tries = 0; tries < 100; ++tries) {
    name = fmt::format("{}{}.{:08x}.{}.{:08x}.part", folder, stem, host_mark(), ::getpid(), random());
    note(name);
    const int file = ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (file >= 0) {
      struct stat old {};
      if (::stat(target.c_str(), &old) == 0 && S_ISREG(old.st_mode)) (void)!::fchmod(file, old.st_mode & 07777);
      return file;
    }
    const int error = errno;
    forget(name);
    errno = error;
    if (error != EEXIST) return -1;
  }
  return -1;
}

void remove_temporary(const std::string& name) {
  const int error = errno;
  ::unlink(name.c_str());
  forget(name);
  errno = error;
}

bool rename_temporary(const std::string& name, const std::string& target) {
  if (std::rename(name.c_str(), target.c_str()) != 0) return false;
  forget(name);
  return true;
}

// Allowed in a signal handler.
void remove_temporaries() {
  for (auto& slot : noted) {
    if (const char* const name = slot.exchange(nullptr)) ::unlink(name);
  }
}

void say_on_signals(const std::string& words) {
  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  speaker.store(::getpid());
  std::free(const_cast<char*>(last_words.exchange(words.empty() ? nullptr : ::strdup(words.c_str()))));
}

void remove_temporaries_on_signals() {
  for (const int signal : {SIGHUP, SIGINT, SIGTERM}) {
    // The caller of the process may have set a signal to be ignored (nohup): that stays.
    if (std::signal(signal, remove_and_end) == SIG_IGN) std::signal(signal, SIG_IGN);
  }
}

}  // namespace accdec
