#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <random>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>

#include <accdec/files/temporaries.hpp>

namespace accdec {
namespace {

/// Names a signal handler can read at any moment. More temporaries at a time than this are not noted, only opened.
std::array<std::atomic<char*>, 256> noted{};

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

extern "C" void remove_and_end(int signal) {
  // Only what may be called in a handler: unlink, signal, raise.
  for (auto& slot : noted) {
    if (const char* const name = slot.exchange(nullptr)) ::unlink(name);
  }
  std::signal(signal, SIG_DFL);
  ::raise(signal);
}

}  // namespace

int open_temporary(const std::string& target, std::string& name) {
  thread_local std::random_device random;
  const std::size_t slash = target.rfind('/');
  const std::string folder = slash == std::string::npos ? "" : target.substr(0, slash + 1);
  // Names may be 255 bytes long in most file systems; the ending is to fit.
  const std::string stem = target.substr(folder.size()).substr(0, 200);
  for (int tries = 0; tries < 100; ++tries) {
    name = fmt::format("{}{}.{:08x}.part", folder, stem, random());
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

void remove_temporaries_on_signals() {
  for (const int signal : {SIGHUP, SIGINT, SIGTERM}) {
    // Whoever started the process may have it ignore a signal (nohup): that stays.
    if (std::signal(signal, remove_and_end) == SIG_IGN) std::signal(signal, SIG_IGN);
  }
}

}  // namespace accdec
