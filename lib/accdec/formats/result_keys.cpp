#include <array>
#include <limits>

#include <accdec/formats/result_keys.hpp>
#include <accdec/formats/settings_json.hpp>
#include <accdec/formats/task_keys.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/result.hpp>
#include <accdec/task/not_considered.hpp>

namespace accdec {
namespace {

using task_keys::delay_limit;
using task_keys::order_limit;

Key text(std::string name, std::string meaning) {
  return {.name = std::move(name),
          .type = KeyType::text,
          .meaning = std::move(meaning),
          .required = true,
          .empty_text = true,
          .long_text = true};
}
Key number(std::string name, std::string meaning, std::string unit = "") {
  return {.name = std::move(name), .meaning = std::move(meaning), .unit = std::move(unit), .required = true};
}
/// A number or null, which the meaning explains.
Key nullable(Key key) {
  key.nullable = true;
  return key;
}
Key optional(Key key) {
  key.required = false;
  return key;
}
Key boolean(std::string name, std::string meaning) {
  return {.name = std::move(name), .type = KeyType::boolean, .meaning = std::move(meaning), .required = true};
}
Key integer(std::string name, std::string meaning, std::string unit, Range range) {
  return {.name = std::move(name),
          .type = KeyType::integer,
          .meaning = std::move(meaning),
          .unit = std::move(unit),
          .range = range,
          .required = true};
}
template <class Enum, std::size_t N>
Key word(std::string name, std::string meaning, const std::array<Enum, N>& all) {
  Key key{.name = std::move(name), .type = KeyType::word, .meaning = std::move(meaning), .required = true};
  for (const Enum one : all) key.words.emplace_back(to_string(one));
  return key;
}
template <class Enum, std::size_t N>
Key words(std::string name, std::string meaning, const std::array<Enum, N>& all) {
  Key key = word(std::move(name), std::move(meaning), all);
  key.type = KeyType::words;
  key.least = 0;
  return key;
}
Key table(std::string name, KeyType type, std::string meaning, std::vector<Key> keys) {
  return {
      .name = std::move(name), .type = type, .meaning = std::move(meaning), .required = true, .keys = std::move(keys)};
}

Key filter() {
  Key taps{.name = "taps",
           .type = KeyType::numbers,
           .meaning = "N + 1 numbers >= 0 of sum 1",
           .most = static_cast<std::size_t>(order_limit) + 1,
           .required = true};
  return nullable(table("filter", KeyType::table, "null if there is none",
                        {integer("order", "N", "taps less 1", {0, order_limit}), std::move(taps)}));
}

Key corners() {
  return table(
      "corners", KeyType::tables, "every corner in the order of the task",
      {text("name", "name of the corner"), integer("delay_samples", "d", "samples", {0, delay_limit}),
       number("corner_error_m", "distance of the path from the corner point, at samples", "m"),
       number("polyline_error_m", "distance of the polyline through the samples from the corner point", "m"),
       number("contour_deviation_m", "largest distance of the path from the legs", "m"),
       number("speed_min_m_s", "smallest tangential speed", "m/s"),
       number(
           "corner_time_s",
           "(N + 1 + d) T, from where the command leaves leg 1's feed to the motion at leg 2's, and what a corner feed "
           "loses",
           "s"),
       optional(number("settling_time_s",
                       "behind a servo: from the end of the command until the motion is within the tolerance of its "
                       "end; left out if 0",
                       "s")),
       optional(
           number("feed_part",
                  "with a corner feed: part of both feeds at which the corner is passed, above 0; left out if 1"))});
}

Key limits() {
  std::array<LimitKind, limit_names.size()> kinds{};
  for (std::size_t i = 0; i < kinds.size(); ++i) kinds[i] = limit_names[i].kind;
  return table(
      "limits", KeyType::tables, "use of every limit, in SI units; axes a, b and c in rad, and in N m of kind force",
      {word("kind", "which limit", kinds), text("axis", "axis; empty if the limit has none"),
       text("corner", "corner; empty if the limit has none"),
       word("event", "where it is used most", std::array{Event::start, Event::blend, Event::stop, Event::none}),
       nullable(number("value", "largest value; null: infinite")), number("bound", "allowed value"),
       nullable(number("utilisation", "value / bound; null: infinite")),
       integer("sample", "sample of the largest value", "samples", {-10.0 * order_limit, 10.0 * order_limit}),
       optional(nullable(number("frequency_Hz", "frequency of a vibration", "Hz"))),
       optional(number("damping_ratio", "damping ratio of a vibration; left out if 0"))});
}

Key circle() {
  return optional(
      table("circle", KeyType::table, "a circle passed at constant feed (`evaluate --circle-radius-mm`)",
            {number("radius_m", "radius of the command", "m"), number("feed_m_s", "feed along the circle", "m/s"),
             number("radius_error_m", "how much smaller the radius of the path is", "m"),
             number("small_angle_m", "first term of the radius error, v^2 sigma^2 / (2 R)", "m"),
             number("simulated_m", "largest distance of a simulated turn from the circle", "m"),
             number("deviation_s", "sigma, the standard deviation of the taps", "s")}));
}

Key quantisation() {
  Key coefficients{.name = "coefficients",
                   .type = KeyType::numbers,
                   .meaning = "one for each tap, >= 0, of sum 2^bits",
                   .range = {0.0, 2147483648.0},
                   .most = static_cast<std::size_t>(order_limit) + 1,
                   .required = true,
                   .whole = true};
  return optional(
      table("quantisation", KeyType::table, "of a task with `coefficient_bits`: taps in whole numbers",
            {integer("bits", "the taps are coefficients over 2^bits", "bits", {1, 31}), std::move(coefficients),
             number("unquantised_s", "the best design known of free taps, of what the task minimises", "s")}));
}

Key savings() {
  return optional(table(
      "savings", KeyType::table, "what the design saves against the task's [baseline]",
      {number("today_s", "time with the [baseline] and its smallest delays", "s"),
       number("total_s", "what the design saves, the sum of the three steps", "s"),
       nullable(number("by_retuning_s", "saved by the best parameters of the same family; null: not searched", "s")),
       nullable(number("by_family_s", "further saved by the best family, at least; null: not searched", "s")),
       nullable(number("by_free_taps_s", "further saved by free taps, at most; null: no family was searched", "s")),
       text("family", "best of all families, as in `best_family` of tables; empty if none was searched"),
       boolean("complete", "whether every family was searched to the end; then the last two savings are exact")}));
}

FileKind make_result_file() {
  Key schema{.name = "schema", .type = KeyType::word, .meaning = "kind of file and its version", .required = true};
  schema.words = {"accdec.result/1"};
  Key task = table("task", KeyType::table, "the task as it was understood", task_file().keys);
  task.free = true;  // has its own reader
  Key certificate = optional(table("certificate", KeyType::table, "proof of the lower bound, for `accdec verify`", {}));
  certificate.free = certificate.nullable = true;
  FileKind file{.name = "result", .title = "accdec result"};
  file.keys = {
      schema,
      word("status", "`optimal` is proved",
           std::array{Status::optimal, Status::feasible, Status::infeasible, Status::failed}),
      optional(word("stop", "why the search ended; unless it `finished`, more time may improve the result",
                    std::to_array(stop_reasons))),
      text("message", "explanation for people"),
      task,
      optional(words("not_considered", "what the result leaves out: modes the task does not name, the servo",
                     not_considered_all)),
      number("sample_period_s", "sample period of the task", "s"),
      filter(),
      corners(),
      number("cycle_time_s", "sum of weight * d * T + runs (N + 1) T, and what corner feeds lose; 0 without a design",
             "s"),
      number("corner_time_s",
             "sum of weight * `corner_time_s` of the corners, each by itself between two stops: what `objective = "
             "\"corner\"` minimises; 0 without a design",
             "s"),
      optional(nullable(number("lower_bound_s", "proved lower bound of the minimised time; null: none is known", "s"))),
      optional(nullable(number("gap", "(time - lower bound) / time; null: no bound"))),
      optional(table("settings", KeyType::table, "what to set, for a task that names families of a controller",
                     chosen_settings_keys())),
      optional(Key{.name = "answer",
                   .type = KeyType::text,
                   .meaning = "what to set, for a control of free taps or whole coefficients",
                   .long_text = true}),
      optional(nullable(number("family_bound_s", "nothing of the task's families is shorter; null: not proved", "s"))),
      optional(nullable(
          number("free_taps_s",
                 "best design known of free taps with delays of any number of samples; null: none is known", "s"))),
      limits(),
      table("verification", KeyType::table, "what the simulation of the design found",
            {boolean("performed", "whether it was simulated"), boolean("feasible", "whether every limit holds"),
             nullable(number("max_violation", "largest utilisation - 1; null: infinite")),
             number("tolerance", "violation that counts as rounding"), text("worst", "limit that is used most"),
             optional(nullable(boolean("certificate_checked", "whether the proof was checked"))),
             optional(nullable(text("certificate", "what the check found")))}),
      table("solver", KeyType::table, "how the design was found",
            {text("method", "exact, nlp, .."), text("name", "name of the solver"),
             text("version", "version of its library"), text("claimed", "what the solver said about its answer"),
             integer("evaluations", "number of function evaluations", "",
                     {0, static_cast<double>(std::numeric_limits<long>::max() / 4)}),
             number("wall_time_s", "time of the solve alone", "s")}),
      quantisation(),
      savings(),
      certificate,
      circle()};
  return file;
}

}  // namespace

const FileKind& result_file() {
  static const FileKind file = make_result_file();
  return file;
}

}  // namespace accdec
