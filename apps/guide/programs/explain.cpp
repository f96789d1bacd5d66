#include <cstdio>

#include <accdec/design.hpp>
#include <accdec/task.hpp>

int main() {
  for (const accdec::Gain& gain : accdec::explain_task(accdec::read_task("task.toml")).gains) {
    std::printf("%-26s saves %g ms\n", gain.room.name.c_str(), 1e3 * gain.gain);
  }
}
