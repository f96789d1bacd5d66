#include <accdec/design/design.hpp>
#include <accdec/formats/design_report.hpp>
#include <accdec/formats/task_reader.hpp>

int main() {
  const accdec::Task task = accdec::read_task("problems/corner/acceleration-jerk.toml");
  accdec::print_result(accdec::design_task(task));
}
