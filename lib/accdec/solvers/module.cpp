#include <stdexcept>

#include <dlfcn.h>

#include <fmt/format.h>

#include <accdec/solvers/module.hpp>

namespace accdec::solvers {

void* module_address(const std::string& module, const char* function) {
  const std::string file = "accdec-" + module + ".so";
  void* const opened = ::dlopen(file.c_str(), RTLD_LAZY | RTLD_LOCAL);
  void* const address = opened == nullptr ? nullptr : ::dlsym(opened, function);
  if (address != nullptr) return address;
  const char* const reason = ::dlerror();
  throw std::runtime_error(fmt::format("cannot load {}, which connects another library: {}", file,
                                       reason == nullptr ? "no reason given" : reason));
}

}  // namespace accdec::solvers
