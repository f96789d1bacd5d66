#include <algorithm>
#include <functional>
#include <map>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/batch/shards.hpp>
#include <accdec/formats/task_tree.hpp>
#include <accdec/formats/toml_file.hpp>
#include <accdec/study/study_parts.hpp>
#include <accdec/study/study_tasks.hpp>

namespace accdec {
namespace {

std::optional<InputError> fault_of(const std::function<void()>& make) {
  try {
    make();
    return std::nullopt;
  } catch (const InputError& error) {
    return error;
  }
}

/// @throws InputError with everything wrong in a task file if that error is among it
void refuse_file(const std::string& path, const InputError& error) {
  const auto same = [&](const InputError& one) { return one.message() == error.message(); };
  try {
    task_from_tree(toml_input::parse_file(path), path, "", {.response = Considered::all});
  } catch (const InputErrors& errors) {
    if (std::any_of(errors.all().begin(), errors.all().end(), same)) throw;
  } catch (const InputError& one) {
    if (same(one)) throw;
  }
}

/// @throws InputError if one place is at fault in all points
void refuse_case(const Study::Tasks& tasks, const StudyPlaces& places, std::size_t c,
                 const std::vector<InputError>& faults) {
  const InputError& first = faults.front();
  const Study::Tasks::Source& source = tasks.cases[c];
  const auto same = [&](const std::optional<InputError>& other) {
    return other && other->message() == first.message();
  };
  // Read again, because copies of a tree have no line numbers.
  refuse_file(source.path, first);
  const auto with_settings =
      fault_of([&] { task_from_tree(places.bases[c], source.path, "", {.response = Considered::all}); });
  if (same(with_settings))
    throw InputError(places.path, places.settings[c].line, places.settings[c].column,
                     fmt::format("`set` of case \"{}\" makes no task: {}", places.names[c], first.message()));
  std::map<std::string, std::optional<std::size_t>> known;
  std::optional<std::size_t> axis;
  for (const InputError& fault : faults) {
    const auto [found, added] = known.try_emplace(fault.pointer());
    if (added) found->second = setter_of(source.tree, tasks.keys, fault.pointer());
    if (!found->second || (axis && axis != found->second)) return;
    axis = found->second;
  }
  const study::Variation& v = places.variations[*axis];
  throw InputError(
      places.path, places.keys[*axis].line, places.keys[*axis].column,
      fmt::format("no value of `{}` makes a task{}: {}", fmt::join(v.keys, "`, `"),
                  places.names[c].empty() ? "" : fmt::format(" of case \"{}\"", places.names[c]), first.message()));
}

}  // namespace

void check_points(const Study& study, const Study::Tasks& tasks, const StudyPlaces& places) {
  const std::size_t per_case = study.points().size() / study.points().cases().size();
  for (std::size_t c = 0; c < study.points().cases().size(); ++c) {
    const auto fault = [&](std::size_t i) { return fault_of([&] { study.task(c * per_case + i); }); };
    // Usually the first point is enough, and the others need not even be listed.
    if (!fault(0) || !fault(per_case / 2) || !fault(per_case - 1)) continue;
    std::vector<InputError> faults;
    for (const std::size_t i : batch::shard(per_case, 1, (per_case + most_probed - 1) / most_probed)) {
      auto found = fault(i);
      if (!found) break;
      faults.push_back(std::move(*found));
    }
    if (faults.size() >= std::min(per_case, most_probed)) refuse_case(tasks, places, c, faults);
  }
}

}  // namespace accdec
