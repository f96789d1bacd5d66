#pragma once

#include <string>

namespace accdec::solvers {

/// A module is a shared object accdec-NAME.so that holds what calls one optimisation library. It is loaded when one of
/// its functions is asked for first, because the loader takes longer to bind these libraries (6 ms, measured) than most
/// designs take. The loader finds it by the run path of the program (CMakeLists.txt sets it) or by LD_LIBRARY_PATH. It
/// stays loaded.
/// @throws std::runtime_error naming the file and the loader's reason
void* module_address(const std::string& module, const char* function);

/// The module's function of this type, which is declared extern "C".
template <class Function>
Function* module_function(const std::string& module, const char* function) {
  return reinterpret_cast<Function*>(module_address(module, function));
}

}  // namespace accdec::solvers
