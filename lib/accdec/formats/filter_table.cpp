#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include <accdec/formats/filter_table.hpp>
#include <accdec/formats/task_keys.hpp>

namespace accdec {
namespace {

using toml_input::Table;

/// Reads one parameter into a spec, by the type of its member.
void read_parameter(const Table& table, const ShapeParameter& parameter, FilterSpec& spec) {
  const auto list = [&](const char* what) {
    if (!table.has(parameter.key)) {
      table.fail(fmt::format("a filter of kind \"{}\" needs `{}`; allowed is an array of {}", to_string(spec.kind),
                             parameter.key, what));
    }
    return table.numbers(parameter.key);
  };
  if (const auto* whole = std::get_if<int FilterSpec::*>(&parameter.member)) {
    spec.** whole = table.required_integer(parameter.key);
  } else if (const auto* real = std::get_if<double FilterSpec::*>(&parameter.member)) {
    spec.** real = table.required_number(parameter.key);
  } else if (const auto* lengths = std::get_if<std::vector<int> FilterSpec::*>(&parameter.member)) {
    for (const double length : list("whole numbers of taps")) (spec.**lengths).push_back(static_cast<int>(length));
  } else {
    spec.*std::get<std::vector<double> FilterSpec::*>(parameter.member) = list("N + 1 non-negative numbers");
  }
}

/// The order that follows from a shape's parameter.
int own_order(const FilterSpec& spec) {
  double order = spec.kind == Shape::taps ? static_cast<double>(spec.taps.size()) - 1.0 : 0.0;
  for (const int length : spec.lengths) order += length - 1.0;
  return static_cast<int>(std::min(order, static_cast<double>(task_keys::order_limit) + 1.0));
}

void read_shaper(const Table& table, FilterSpec& spec) {
  if (table.has("shaper")) {
    const ShaperInfo& shaper = *find_shaper(table.word("shaper"));
    spec.pairs = shaper.pairs;
    spec.outer = shaper.outer;
    spec.pair_delay = table.required_number("shaper_delay");
  } else if (table.has("shaper_delay")) {
    table.fail_at("shaper_delay",
                  "`shaper_delay` needs `shaper`; allowed is shaper = \"zv\", \"zvd\", \"mzv\" or \"ei\"");
  }
}

}  // namespace

FilterSpec read_filter(const Table& table) {
  const std::string kind = table.word("kind");
  FilterSpec spec;
  spec.kind = *shape_from_string(kind);
  const ShapeInfo& shape = info(spec.kind);
  for (const ShapeInfo& other : shape_list()) {
    if (&other == &shape || !other.parameter || !table.has(other.parameter->key)) continue;
    table.fail_at(other.parameter->key, fmt::format("`{}` has no meaning for kind \"{}\"; it goes with kind \"{}\"",
                                                    other.parameter->key, kind, other.name));
  }
  if (shape.has_order) spec.order = table.required_integer("order");
  if (shape.parameter) read_parameter(table, *shape.parameter, spec);
  if (!shape.has_order) {
    spec.order = own_order(spec);
    const int most = task_keys::order_limit;
    if (spec.order > most) table.fail_at(shape.parameter->key, fmt::format("the order is above {}", most));
    if (const auto order = table.integer("order"); order && *order != spec.order) {
      const std::string given =
          spec.kind == Shape::taps ? fmt::format("{} taps", spec.taps.size()) : std::string(shape.parameter->key);
      table.fail_at("order", fmt::format("`order` = {} does not match the {} given; leave it out or write {}", *order,
                                         given, spec.order));
    }
  }
  read_shaper(table, spec);
  try {
    make_filter(spec);
  } catch (const std::invalid_argument& error) {
    // If the order is too small for the shape, the error is at the order, not at the parameter.
    const bool by_order = !shape.parameter || (shape.has_order && spec.order < 2 && spec.kind != Shape::trapezoid);
    table.fail_at(by_order ? "order" : shape.parameter->key, error.what());
  }
  return spec;
}

nlohmann::ordered_json filter_to_json(const FilterSpec& spec) {
  nlohmann::ordered_json filter;
  filter["kind"] = to_string(spec.kind);
  filter["order"] = spec.order;
  if (const auto& parameter = info(spec.kind).parameter) {
    std::visit([&](auto member) { filter[std::string(parameter->key)] = spec.*member; }, parameter->member);
  }
  if (const ShaperInfo* shaper = shaper_of(spec)) {
    filter["shaper"] = shaper->name;
    if (spec.whole_pairs())
      filter["shaper_delay"] = static_cast<int>(spec.pair_delay);
    else
      filter["shaper_delay"] = spec.pair_delay;
  }
  return filter;
}

}  // namespace accdec
