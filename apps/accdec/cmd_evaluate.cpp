#include <memory>
#include <numbers>

#include <fmt/format.h>

#include <accdec/files/output_files.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/task.hpp>
#include <accdec/verify.hpp>

#include "option_checks.hpp"
#include "output.hpp"

namespace accdec::cli {

namespace {

struct EvaluateArguments {
  std::string task, json;
  double circle_radius_mm = 0.0, circle_feed_mm_min = 0.0;
};

CircleRecord evaluate_circle(const Task& task, const EvaluateArguments& options) {
  CircleRecord circle{options.circle_radius_mm * 1e-3, options.circle_feed_mm_min / 6e4, {}};
  circle.error = circle_error(make_filter(*task.filter), task, circle.radius, circle.feed);
  return circle;
}

void print_circle(const Task& task, const EvaluateArguments& options, const CircleError& error) {
  const bool shrinks = Response(task.machine, task.sample_period).common();
  fmt::print(
      "\ncircle of radius {:g} mm at {:g} mm/min: {} {:.4f} um (simulated turn {:.4f} um, "
      "v^2 sigma^2/(2R){} {:.4f} um with sigma = {:.4g} ms)\n",
      options.circle_radius_mm, options.circle_feed_mm_min, shrinks ? "smaller by" : "off by up to",
      1e6 * error.radius_error, 1e6 * error.simulated, shrinks ? "" : " and half the lag between the axes",
      1e6 * error.small_angle, 1e3 * error.deviation);
  const double turn = 2.0 * std::numbers::pi * options.circle_radius_mm / (options.circle_feed_mm_min / 60.0);
  if (turn < make_filter(*task.filter).order() * task.sample_period)
    fmt::print("  the turn takes {:.4g} ms, less than the filter, so no output sample averages over the circle alone\n",
               1e3 * turn);
}

}  // namespace

void add_evaluate(CLI::App& app, Context& context) {
  const auto options = std::make_shared<EvaluateArguments>();
  CLI::App* command =
      app.add_subcommand("evaluate", "Print errors, times and limit use of a given filter with given delays");
  command->add_option("task", options->task, "Task file with a [filter] and delay_samples in every corner")
      ->required()
      ->type_name("TASK.toml");
  add_json_option(*command, options->json);
  auto* radius = command
                     ->add_option("--circle-radius-mm", options->circle_radius_mm,
                                  "Also print the radius error of a circle with this radius")
                     ->check(positive_number());
  auto* feed = command->add_option("--circle-feed-mm-min", options->circle_feed_mm_min, "Feed along this circle")
                   ->check(positive_number());
  radius->needs(feed);
  feed->needs(radius);
  command->callback([options, &context] {
    const Task task = read_task(options->task, {.require_choices = true, .response = Considered::all});
    warn(task, options->task, context);
    require_outputs({options->json}, {options->task});
    std::optional<CircleRecord> circle;
    if (options->circle_radius_mm > 0.0) circle = evaluate_circle(task, *options);
    context.exit_code = deliver(evaluate_task(task), options->json, context, certificate_max_default, circle);
    if (circle && options->json != "-" && !context.quiet) print_circle(task, *options, circle->error);
  });
}

}  // namespace accdec::cli
