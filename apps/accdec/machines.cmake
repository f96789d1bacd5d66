# Writes OUT, a C++ file with the text of every task in FOLDER: what `accdec init` writes is what the repository ships.
file(GLOB files ${FOLDER}/*.toml)
list(SORT files)
set(text [[
#include "machines.hpp"

namespace accdec::cli {

std::span<const MachineFile> machine_files() {
  static constexpr MachineFile files[] = {
]])
foreach(file IN LISTS files)
  get_filename_component(name ${file} NAME_WE)
  file(READ ${file} content)
  string(APPEND text "      {\"${name}\", R\"accdec-task(${content})accdec-task\"},\n")
endforeach()
string(APPEND text [[
  };
  return files;
}

}  // namespace accdec::cli
]])
file(WRITE ${OUT} "${text}")
