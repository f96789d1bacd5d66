#include <accdec/design/design.hpp>
#include <accdec/io/report.hpp>
#include <accdec/io/task_reader.hpp>

int main() {
  const accdec::Task task = accdec::read_task("problems/corner/acceleration-jerk.toml");
  accdec::print_result(accdec::design_task(task));
}
