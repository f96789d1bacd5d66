#include <accdec/design.hpp>
#include <accdec/task.hpp>

int main() {
  const accdec::Task task = accdec::read_task("problems/corner/acceleration-jerk.toml");
  accdec::print_result(accdec::design_task(task));
}
