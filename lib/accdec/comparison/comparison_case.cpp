#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/comparison/comparison_case.hpp>
#include <accdec/corner.hpp>
#include <accdec/files/words.hpp>
#include <accdec/filter.hpp>
#include <accdec/machine/blend_behind.hpp>
#include <accdec/machine/response.hpp>

namespace accdec::comparison {
namespace {

Filter default_filter(int order) {
  return order < 2 ? boxcar(order) : trapezoid(order, order / 3);
}

/// @param motion  that of the filter behind the machine's response
std::vector<double> default_delays(const Task& task, const Filter& motion) {
  const DelayFinder smallest(motion);
  std::vector<double> delays;
  for (const TaskCorner& corner : task.corners) {
    const double period = task.sample_period;
    const bool chosen = !corner.delay && corner.error_max;
    delays.push_back(chosen ? smallest(corner.geometry().cos_interior(), corner.geometry().feed_in * period,
                                       corner.geometry().feed_out * period, *corner.error_max)
                            : corner.delay.value_or(0));
  }
  return delays;
}

/// Uniform in [low, high), the same with every standard library.
double uniform(std::mt19937_64& rng, double low, double high) {
  return low + (high - low) * (static_cast<double>(rng() >> 11) * 0x1p-53);
}

/// Why designs of a task are not ones of free taps and delays; empty if they are.
std::string given_choices(const Task& task) {
  std::string keys;
  const auto add = [&](const char* key) { keys += fmt::format("{}{}", keys.empty() ? "" : ", ", key); };
  if (task.filter) add("[filter]");
  if (task.design.coefficient_bits > 0) add("[design] coefficient_bits");
  if (task.settings && task.settings->names_family())
    add(task.settings->from_file ? "[controller] name" : "[design] family");
  else if (task.settings && !task.settings->any_delay())
    add("[controller] delays");
  if (keys.empty()) return "";
  return "the problem is one of free taps and of delays of any number of samples; the task narrows these choices: " +
         keys;
}

constexpr std::array<std::pair<Question, std::string_view>, 3> question_words{
    {{Question::margin, "margin"}, {Question::delay, "delay"}, {Question::design, "design"}}};
constexpr std::array<std::pair<Expected, std::string_view>, 3> expected_words{
    {{Expected::feasible, "feasible"}, {Expected::infeasible, "infeasible"}, {Expected::unknown, "unknown"}}};

}  // namespace

std::string_view to_string(Question question) {
  return word_of(question_words, question);
}

std::optional<Question> question_from_string(std::string_view name) {
  return value_of<Question>(question_words, name);
}

std::string_view to_string(Expected expected) {
  return word_of(expected_words, expected);
}

std::optional<Expected> expected_from_string(std::string_view name) {
  return value_of<Expected>(expected_words, name);
}

CaseSpec refined(CaseSpec spec, int factor) {
  if (factor < 1) throw std::invalid_argument("a size must be at least 1");
  spec.size = factor;
  spec.order = factor * (spec.order + 1) - 1;
  spec.task.sample_period /= factor;
  for (int& d : spec.delays) d *= factor;
  for (TaskCorner& corner : spec.task.corners) {
    if (corner.delay) *corner.delay *= factor;
  }
  return spec;
}

ComparisonCase::ComparisonCase(CaseSpec spec) : spec_(std::move(spec)) {
  const Task& task = spec_.task;
  objection_ = given_choices(task);
  delays_given_ = !spec_.delays.empty();
  if (spec_.question == Question::design) return;
  const Filter filter = default_filter(spec_.order);
  const FilterBehind behind(filter, task.machine, task.sample_period);
  FormulationOptions options;
  options.order = spec_.order;
  options.margin = 0.0;
  options.mode_frequencies = initial_frequencies(task, spec_.order);
  if (spec_.question == Question::margin) {
    if (!delays_given_) {
      for (const TaskCorner& corner : task.corners) spec_.delays.push_back(corner.delay.value_or(0));
      delays_given_ = std::ranges::any_of(task.corners, [](const auto& c) { return c.delay.has_value(); });
    }
    options.blend_delays = spec_.delays;
    for (std::size_t j = 0; j < task.corners.size(); ++j) {
      samples_.push_back(
          measure(behind, task.corners[j].geometry(), spec_.delays[j], task.sample_period).corner_error_sample);
    }
  } else if (!spec_.delays.empty()) {
    options.blend_delays = spec_.delays;
  } else {
    for (const double d : default_delays(task, behind.motion())) options.blend_delays.push_back(static_cast<int>(d));
  }
  if (objection_.empty()) objection_ = friction_both_ways(task);
  if (objection_.empty()) objection_ = unstated_error(behind.longest_order());
  blend_delays_ = options.blend_delays;
  options.mode_blends = true;
  for (std::size_t j = 0; j < task.corners.size(); ++j)
    options.contour_times.push_back(contour_time(behind.motion(), task.corners[j].geometry(), blend_delays_[j]));
  for (const bool reduced : {false, true}) {
    options.reduced = reduced;
    auto& slot = reduced ? reduced_ : sparse_;
    if (spec_.question == Question::margin) {
      slot = std::make_unique<MarginProblem>(task, options, samples_);
    } else {
      slot = std::make_unique<DelayProblem>(task, options);
    }
  }
  std::map<std::string, std::size_t> names;
  for (int i = 0; i < sparse_->num_variables(); ++i) names[sparse_->variable_name(i)] = static_cast<std::size_t>(i);
  for (int i = 0; i < reduced_->num_variables(); ++i) common_.push_back(names.at(reduced_->variable_name(i)));
}

std::string ComparisonCase::unstated_error(int longest) const {
  for (std::size_t j = 0; j < spec_.task.corners.size(); ++j) {
    const TaskCorner& corner = spec_.task.corners[j];
    const bool at_point = corner.error_max == 0.0;
    if (!at_point && corner.contour_max != 0.0) continue;
    // The suite's delays are no choice of a DelayProblem: it only imposes limits on the blends there.
    const int least = spec_.question == Question::margin ? spec_.delays[j] : corner.delay.value_or(0);
    if (least < longest)
      return fmt::format(
          "corner {}: {} = 0 is an exact stop. No row of a `{}` problem states it, and its delay may be shorter than "
          "the filter",
          corner.name, at_point ? "error_max_um" : "contour_max_um", to_string(spec_.question));
  }
  if (std::ranges::none_of(spec_.task.corners, [](const TaskCorner& c) { return c.error_max.value_or(0.0) > 0.0; }))
    return fmt::format("a `{}` problem needs a corner with error_max_um > 0", to_string(spec_.question));
  return "";
}

std::mt19937_64 ComparisonCase::generator(int index, std::uint64_t seed) const {
  std::seed_seq sequence{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32),
                         static_cast<std::uint32_t>(index), static_cast<std::uint32_t>(spec_.order)};
  return std::mt19937_64(sequence);
}

Filter ComparisonCase::start_filter(int index, std::mt19937_64& rng) const {
  Filter filter = default_filter(spec_.order);
  if (index == 0) return filter;
  std::vector<double> taps;
  for (int i = 0; i <= spec_.order; ++i) taps.push_back(filter.tap(i) * std::exp(uniform(rng, -1.0, 1.0)));
  return Filter(std::move(taps));
}

Filter ComparisonCase::start_filter(int index, std::uint64_t seed) const {
  std::mt19937_64 rng = generator(index, seed);
  return start_filter(index, rng);
}

std::vector<double> ComparisonCase::start(bool reduced, int index, std::uint64_t seed) const {
  std::mt19937_64 rng = generator(index, seed);
  const Filter filter = start_filter(index, rng);
  const Filter first = default_filter(spec_.order);
  const FilterBehind behind(first, spec_.task.machine, spec_.task.sample_period);
  std::vector<double> delays = default_delays(spec_.task, behind.motion());
  for (std::size_t j = 0; index > 0 && j < delays.size(); ++j) {
    const double factor = uniform(rng, 0.5, 1.5);
    if (!spec_.task.corners[j].delay) delays[j] = std::min(delays[j] * factor, behind.longest_order() + 1.0);
  }
  const nlp::Problem* p = problem(reduced);
  if (const auto* margin = dynamic_cast<const MarginProblem*>(p)) return margin->start_from(filter);
  return dynamic_cast<const DelayProblem&>(*p).start_from(filter, delays);
}

std::vector<double> ComparisonCase::to_reduced(bool reduced, const std::vector<double>& x) const {
  if (reduced) return x;
  std::vector<double> result;
  for (const std::size_t i : common_) result.push_back(x[i]);
  return result;
}

int ComparisonCase::variables() const {
  return reduced_ ? reduced_->num_variables() : spec_.order + static_cast<int>(spec_.task.corners.size());
}

int ComparisonCase::rows() const {
  return reduced_ ? reduced_->num_rows() : 0;
}

std::string ComparisonCase::asks() const {
  switch (spec_.question) {
    case Question::margin:
      return delays_given_
                 ? fmt::format("taps of least corner error at delay {}", fmt::join(spec_.delays, ", "))
                 : "taps of least corner error without any delay (no delay_samples given: every corner at delay 0)";
    case Question::delay:
      return fmt::format("taps and real delays of least weighted delay; limits on the blends at delay {}{}",
                         fmt::join(blend_delays_, ", "), delays_given_ ? "" : " (of the first start: none given)");
    case Question::design: return "taps and whole delays of least cycle time";
  }
  return "";
}

void describe(batch::Row& row, const char* question, const ComparisonCase& subject) {
  const CaseSpec& spec = subject.spec();
  row["problem"] = spec.name;
  row["family"] = spec.family;
  row[question] = to_string(spec.question);
  row["asks"] = subject.asks();
  row["size"] = spec.size;
  row["order"] = spec.order;
}

}  // namespace accdec::comparison
