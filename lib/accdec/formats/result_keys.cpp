#include <array>
#include <limits>

#include <accdec/formats/result_keys.hpp>
#include <accdec/formats/task_keys.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/task/result.hpp>

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
      {text("name", "of the corner"), integer("delay_samples", "d", "samples", {0, delay_limit}),
       number("corner_error_m", "distance of the path from the corner point, at samples", "m"),
       number("polyline_error_m", "the same of the polyline through the samples", "m"),
       number("contour_deviation_m", "largest distance of the path from the legs", "m"),
       number("speed_min_m_s", "smallest tangential speed", "m/s"), number("corner_time_s", "(N + 1 + d) T", "s")});
}

Key limits() {
  std::array<LimitKind, limit_names.size()> kinds{};
  for (std::size_t i = 0; i < kinds.size(); ++i) kinds[i] = limit_names[i].kind;
  return table(
      "limits", KeyType::tables, "use of every limit; SI",
      {word("kind", "which limit", kinds), text("axis", "empty if of none"), text("corner", "empty if of none"),
       word("event", "where it is used most", std::array{Event::start, Event::blend, Event::stop, Event::none}),
       nullable(number("value", "largest value; null: infinite")), number("bound", "what is allowed"),
       nullable(number("utilisation", "value / bound; null: infinite")),
       integer("sample", "of the largest value", "samples", {-10.0 * order_limit, 10.0 * order_limit}),
       optional(nullable(number("frequency_Hz", "of a vibration", "Hz")))});
}

Key circle() {
  return optional(table("circle", KeyType::table, "of `evaluate --circle-radius-mm`: a circle passed at constant feed",
                        {number("radius_m", "of the command", "m"), number("feed_m_s", "along it", "m/s"),
                         number("radius_error_m", "by how much the path is smaller", "m"),
                         number("small_angle_m", "the same by its first term, v^2 sigma^2 / (2 R)", "m"),
                         number("simulated_m", "largest distance of a simulated turn from the circle", "m"),
                         number("deviation_s", "sigma, the standard deviation of the taps", "s")}));
}

FileKind make_result_file() {
  Key schema{.name = "schema", .type = KeyType::word, .meaning = "kind of file and its version", .required = true};
  schema.words = {"accdec.result/1"};
  Key task = table("task", KeyType::table, "the task as it was understood", task_file().keys);
  task.free = true;  // has a reader of its own
  Key certificate = optional(table("certificate", KeyType::table, "proof of the lower bound, for `accdec verify`", {}));
  certificate.free = certificate.nullable = true;
  FileKind file{.name = "result", .title = "accdec result"};
  file.keys = {
      schema,
      word("status", "`optimal` is proved",
           std::array{Status::optimal, Status::feasible, Status::infeasible, Status::failed}),
      optional(word("stop", "why the search ended; after all but `finished` more time might lead further",
                    std::to_array(stop_reasons))),
      text("message", "what there is to say, for people"),
      task,
      number("sample_period_s", "that of the task", "s"),
      filter(),
      corners(),
      number("cycle_time_s", "sum of weight * d * T + runs (N + 1) T", "s"),
      number("corner_time_s", "sum of weight * (N + 1 + d) T", "s"),
      optional(nullable(number("lower_bound_s", "of what the task minimises; null: none is known", "s"))),
      optional(nullable(number("gap", "(time - lower bound) / time; null: no bound"))),
      limits(),
      table("verification", KeyType::table, "what the simulation of the design found",
            {boolean("performed", "whether it was simulated"), boolean("feasible", "whether every limit holds"),
             nullable(number("max_violation", "largest utilisation - 1; null: infinite")),
             number("tolerance", "violation that counts as rounding"), text("worst", "limit that is used most"),
             optional(nullable(boolean("certificate_checked", "whether the proof was checked"))),
             optional(nullable(text("certificate", "what the check found")))}),
      table("solver", KeyType::table, "how the design was found",
            {text("method", "exact, nlp, .."), text("name", "of the solver"), text("version", "of its library"),
             text("claimed", "what the solver said of its answer"),
             integer("evaluations", "of functions", "", {0, static_cast<double>(std::numeric_limits<long>::max() / 4)}),
             number("wall_time_s", "of the solve alone", "s")}),
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
