// Feeds a fuzz target with mutated files as fast as it reads them, and ignores which code they reach: fuzz_NAME_bulk
// SECONDS SEED FOLDER.. . An input that ends the process is left in crash-input. ; an input that ends the process is
// left in crash-input. Told to end (SIGTERM, Ctrl-C), it says how many it has read.

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include <fcntl.h>
#include <unistd.h>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

std::string input;  // what the target has now
volatile std::sig_atomic_t told_to_end = 0;

extern "C" void keep_input(int signal) {
  const int file = open("crash-input", O_WRONLY | O_CREAT | O_TRUNC, 0644);
  const bool kept = file >= 0 && write(file, input.data(), input.size()) >= 0;
  constexpr char said[] = "the input is in crash-input\n";
  if (kept && write(STDERR_FILENO, said, sizeof said - 1) < 0) _exit(3);
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

std::vector<std::string> files_in(int count, char** folders) {
  std::vector<std::string> files;
  for (int i = 0; i < count; ++i) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folders[i])) {
      std::ifstream in(entry.path(), std::ios::binary);
      if (entry.is_regular_file() && entry.file_size() <= 4096)
        files.emplace_back(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
    }
  }
  // The order of a folder is nobody's; a seed is to give the same inputs again.
  std::sort(files.begin(), files.end());
  return files;
}

class Mutator {
 public:
  Mutator(std::vector<std::string> files, unsigned seed) : files_(std::move(files)), random_(seed) {}

  void next(std::string& text) {
    text = any();
    for (std::size_t changes = 1 + below(4); changes > 0; --changes) change(text);
  }

 private:
  std::size_t below(std::size_t n) { return n == 0 ? 0 : random_() % n; }
  const std::string& any() { return files_[below(files_.size())]; }

  void change(std::string& text) {
    const std::size_t at = below(text.size() + 1), length = 1 + below(below(8) == 0 ? 64 : 6);
    switch (below(6)) {
      case 0: text.insert(at, 1, static_cast<char>(random_())); break;
      case 1: text.erase(at, length); break;
      case 2: text.insert(at, text, below(text.size()), length); break;
      case 3:
        if (at < text.size()) text[at] = static_cast<char>(text[at] ^ (1U << below(8)));
        break;
      case 4:
        if (at < text.size()) text[at] = "0123456789.-+eE\"\n []{}=,#"[below(25)];
        break;
      default: {
        const std::string& other = any();
        text.replace(at, below(8), other, below(other.size()), length);
      }
    }
    if (text.size() > 4096) text.resize(4096);
  }

  std::vector<std::string> files_;
  std::mt19937 random_;
};

}  // namespace

int main(int count, char** arguments) {
  if (count < 4) return std::fprintf(stderr, "usage: %s SECONDS SEED FOLDER..\n", arguments[0]), 2;
  for (const int signal : {SIGSEGV, SIGABRT, SIGFPE, SIGBUS, SIGILL}) std::signal(signal, keep_input);
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, [](int) { told_to_end = 1; });
  Mutator mutator(files_in(count - 3, arguments + 3), static_cast<unsigned>(std::atol(arguments[2])));
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::duration<double>(std::atof(arguments[1]));
  long inputs = 0;
  for (; inputs % 256 != 0 || (told_to_end == 0 && Clock::now() < end); ++inputs) {
    mutator.next(input);
    LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(input.data()), input.size());
  }
  std::printf("%ld inputs\n", inputs);
}
