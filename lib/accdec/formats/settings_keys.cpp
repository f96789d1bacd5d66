#include <string>

#include <fmt/format.h>

#include <accdec/formats/settings_table.hpp>
#include <accdec/machine/response.hpp>

namespace accdec {
namespace {

constexpr double longest_ms = 1e6;
constexpr std::size_t most_stages = 3, longest_set = 1000;

template <class Names>
std::vector<std::string> words_of(const Names& names) {
  std::vector<std::string> words;
  for (const auto& name : names) words.emplace_back(name.name);
  return words;
}

Key time_key(std::string name, std::string meaning, std::string fallback, std::string example, bool of_period) {
  return {.name = std::move(name),
          .type = KeyType::numbers,
          .meaning = std::move(meaning),
          .unit = "ms",
          .range = {0.0, longest_ms, true},
          .most = most_stages,
          .fallback = std::move(fallback),
          .example = std::move(example),
          .lone = true,
          .of_period = of_period};
}

/// How the control delays a corner.
std::vector<Key> about_delays() {
  return {
      {.name = "delays",
       .type = KeyType::words,
       .meaning = "how it delays the second leg of a corner; the design uses only these, the best one at each corner. "
                  "An exact "
                  "stop lasts until filter and `prefilter_taps` are empty, zero taps included",
       .words = words_of(delay_kinds),
       .noun = "kind of delay",
       .fallback = "any number of samples",
       .example = "[\"in-position\"]"},
      {.name = "delay_words",
       .type = KeyType::texts,
       .meaning = "what a program says for each of `delays`, in their order: on the block before the corner, that of "
                  "continuous once; empty: nothing",
       .fallback = "not known",
       .example = "[\"G9 G602\"]",
       .empty_text = true},
      {.name = "in_position_of",
       .type = KeyType::word,
       .meaning = "with \"in-position\": the position that it looks at: commanded, behind any `prefilter_taps`, or "
                  "behind the servo that [[axis]] gives",
       .words = {"command", "actual"},
       .fallback = "command",
       .example = "\"actual\""},
      {.name = "in_position_by",
       .type = KeyType::word,
       .meaning = "with \"in-position\": what must be within the width: the way along the path, or that of each axis",
       .words = {"path", "axis"},
       .fallback = "path",
       .example = "\"axis\""},
      {.name = "in_position_latency_ms",
       .meaning = "with \"in-position\": time from entering the width to the start of the next block; a multiple of "
                  "the period",
       .unit = "ms",
       .range = {0.0, longest_ms},
       .fallback = "0",
       .example = "2",
       .of_period = true},
      {.name = "corner_feed_step",
       .meaning = "with \"corner-feed\": corners are passed at multiples of this fraction of both feeds, below 1. The "
                  "lower feed lasts until the motion has settled, N + 2 samples before and behind the corner; shorter "
                  "stretches, which may be faster, are not considered",
       .range = {0.001, 0.5},
       .fallback = "0.05",
       .example = "0.1"}};
}

/// The controller's file, its parameters and its own smoothing.
std::vector<Key> about_parameters() {
  return {
      {.name = "name",
       .type = KeyType::text,
       .meaning = "a built-in controller, see `accdec controllers`; keys of the task choose among what it has",
       .example = "\"sinumerik-840d\""},
      {.name = "file",
       .type = KeyType::text,
       .meaning = "instead of `name`: a controller's file, beside the task",
       .example = "\"my-control.toml\"",
       .long_text = true},
      {.name = "title",
       .type = KeyType::text,
       .meaning = "heading for people",
       .example = "\"My control\"",
       .long_text = true},
      {.name = "assumed",
       .type = KeyType::texts,
       .meaning = "what no source says of the control and the answer relies on; the answer names it",
       .example = "[\"times are entered in ms\"]",
       .long_text = true},
      {.name = "parameters",
       .type = KeyType::texts,
       .meaning = "one a stage: what the control calls its time",
       .most = most_stages,
       .example = "[\"MD32410\", \"MD32411\"]",
       .empty_text = true,
       .long_text = true},
      {.name = "parameter_units",
       .type = KeyType::texts,
       .meaning = "with `parameters`: unit in which it is entered",
       .most = most_stages,
       .fallback = "ms",
       .example = "[\"s\", \"s\"]"},
      {.name = "parameter_unit_ms",
       .type = KeyType::numbers,
       .meaning = "with `parameters`: ms in one unit",
       .range = {0.0, longest_ms, true},
       .most = most_stages,
       .fallback = "1",
       .example = "[1000, 1000]"},
      {.name = "prefilter_taps",
       .type = KeyType::numbers,
       .meaning =
           "the control's own smoothing of every axis, behind the filter: taps of sum 1. Exact stops wait for it; the "
           "cycle time of a task ends before it",
       .range = {0.0, 1.0},
       .most = response_taps_max,
       .fallback = "none",
       .example = "[0.25, 0.5, 0.25]"},
      {.name = "position_unit_um",
       .meaning = "`accdec program` outputs positions as whole numbers of it; of rotary axes in thousandths of a "
                  "degree",
       .unit = "um",
       .range = {1e-6, 1e3},
       .fallback = "decimals of mm",
       .example = "0.1"}};
}

/// The times of one stage, where stages have sets of their own.
Key set_of_stage(int stage) {
  return {.name = fmt::format("length_set_{}_ms", stage),
          .type = KeyType::numbers,
          .meaning = fmt::format("the times that stage {} can have, where they differ from the others'", stage),
          .unit = "ms",
          .range = {0.0, longest_ms},
          .most = longest_set,
          .example = "[1, 2, 3]",
          .of_period = true};
}

}  // namespace

std::vector<Key> setting_keys() {
  return {
      {.name = "family",
       .type = KeyType::words,
       .meaning =
           "families to design, the best of several: settings of controllers, or free taps if nothing else is as good",
       .words = words_of(setting_families),
       .noun = "family",
       .fallback = "taps",
       .example = "\"averages\""},
      {.name = "stages",
       .type = KeyType::integer,
       .meaning = "with a family: moving averages in series, or poles; each may be off; of other families 1",
       .range = {1, most_stages},
       .fallback = "2",
       .example = "2"},
      {.name = "shaper",
       .type = KeyType::word,
       .meaning = "with family = \"shaper\": impulses behind the averages, at whole samples unless "
                  "`shaper_frequency_step_Hz` is given",
       .words = words_of(shaper_list()),
       .fallback = "zv",
       .example = "\"zv\""},
      time_key("length_step_ms", "with a family: step of its times, a multiple of the period; one, or one a stage",
               "the period", "1", true),
      time_key("length_max_ms", "with a family: longest time; one, or one a stage", "no cap", "32", false),
      {.name = "length_set_ms",
       .type = KeyType::numbers,
       .meaning = "with a family, instead of step and cap: all times that can be set, multiples of the period; off, "
                  "which is always allowed, may stand among them as 0",
       .unit = "ms",
       .range = {0.0, longest_ms},
       .most = longest_set,
       .example = "[0.5, 1, 2, 4, 8]",
       .of_period = true},
      set_of_stage(2),
      set_of_stage(3),
      {.name = "time_constant_step_ms",
       .meaning = "with family = \"exponential\": its time constants are multiples, up to the longest filter",
       .unit = "ms",
       .range = {0.0, longest_ms, true},
       .fallback = "the period",
       .example = "0.5"},
      {.name = "alpha_step",
       .meaning = "with family = \"gaussian\": alpha, the half width over the standard deviation, is a multiple "
                  "up to 6, from the step on; alpha 0 is family = \"averages\" with one stage",
       .range = {gaussian_alpha_max / most_numbers, gaussian_alpha_max},
       .fallback = "0.1",
       .example = "0.25"},
      {.name = "cutoff_step_Hz",
       .meaning = "with family = \"windowed-sinc\": cut-offs are multiples, up to 1 / (N T)",
       .unit = "Hz",
       .range = {0.0, 1e6, true},
       .fallback = "1",
       .example = "5"},
      {.name = "shaper_frequency_step_Hz",
       .meaning = "with family = \"shaper\", of a control that interpolates: the shaper's frequency is a multiple; an "
                  "impulse between two samples is split linearly onto them",
       .unit = "Hz",
       .range = {0.0, 1e6, true},
       .fallback = "whole samples",
       .example = "0.1"}};
}

std::vector<Key> controller_keys() {
  std::vector<Key> keys = about_delays();
  const std::vector<Key> others = about_parameters();
  keys.insert(keys.end(), others.begin(), others.end());
  return keys;
}

}  // namespace accdec
