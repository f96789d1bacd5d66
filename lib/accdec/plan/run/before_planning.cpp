#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include <accdec/plan/report/plan_facts.hpp>
#include <accdec/plan/run/before_planning.hpp>

namespace accdec {

ProgramSubject subject_of(std::string program, const Toolpath& path, const Task& task) {
  ProgramSubject subject;
  subject.program = std::move(program);
  subject.sample_period = task.sample_period;
  subject.task_machine = task.machine;
  subject.programmed_blocks = blocks_of(path);
  subject.programmed_moves = path.blocks();
  return subject;
}

ProgramResult before_planning(const PlanningProblem& problem) {
  const Task& task = problem.task;
  if (task.design.coefficient_bits > 0)
    throw std::invalid_argument("[design] coefficient_bits is for designs of corners; leave it out for a program");
  ProgramResult result;
  static_cast<ProgramSubject&>(result) = subject_of(problem.program, problem.path, task);
  return result;
}

const char* ended_by(const Deadline& deadline) {
  return deadline.asked_to_end() ? "Ctrl-C" : "the time limit";
}

void say_what_ended(ProgramResult& result, const Deadline& deadline) {
  if (!result.verification.feasible && deadline.over())
    result.message =
        fmt::format("{} ended the planning before a plan held all limits; {}", ended_by(deadline), result.message);
}

}  // namespace accdec
