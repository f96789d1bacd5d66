#include <algorithm>
#include <chrono>
#include <mutex>
#include <thread>

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/partitioner.h>
#include <oneapi/tbb/task_arena.h>

#include <accdec/batch/runner.hpp>
#include <accdec/batch/worker_process.hpp>
#include <accdec/files.hpp>

namespace accdec::batch {
namespace {

using Clock = std::chrono::steady_clock;

void run_threads(const std::vector<std::size_t>& indices, const std::function<std::string(std::size_t)>& compute,
                 const std::function<void(std::size_t, const Entry&)>& done, int workers) {
  std::mutex one_at_a_time;
  // More workers than cores are allowed if requested. Without this line oneTBB would complain on standard error and
  // limit them.
  const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism,
                                          static_cast<std::size_t>(workers));
  oneapi::tbb::task_arena arena(workers);
  arena.execute([&] {
    oneapi::tbb::parallel_for(
        std::size_t{0}, indices.size(), std::size_t{1},
        [&](std::size_t i) {
          const auto began = Clock::now();
          Entry entry;
          entry.row = compute(indices[i]);
          entry.seconds = seconds_since(began);
          const std::lock_guard lock(one_at_a_time);
          done(indices[i], entry);
        },
        // Points differ in cost by orders of magnitude, so each is a separate piece of work.
        oneapi::tbb::simple_partitioner());
  });
}

}  // namespace

int workers_of(const RunOptions& options) {
  return options.workers > 0 ? options.workers : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

void run_points(const std::vector<std::size_t>& indices, const std::function<std::string(std::size_t)>& compute,
                const std::function<std::string(std::size_t, const std::string&)>& lost,
                const std::function<void(std::size_t, const Entry&)>& done, const RunOptions& options) {
  const int workers = std::min(workers_of(options), std::max(1, static_cast<int>(indices.size())));
  if (options.isolation == Isolation::threads) {
    run_threads(indices, compute, done, workers);
  } else {
    const auto kill_after =
        options.kill_after_of ? options.kill_after_of : [t = options.kill_after](std::size_t) { return t; };
    run_processes(indices, compute, lost, done, workers, kill_after, options.fresh_children);
  }
}

}  // namespace accdec::batch
