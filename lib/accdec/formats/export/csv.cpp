#include <algorithm>

#include <fmt/format.h>

#include <accdec/files/csv_table.hpp>
#include <accdec/formats/export/exported_design.hpp>

namespace accdec {
namespace {

/// A cell on one line.
std::string csv_cell(std::string text) {
  std::ranges::replace_if(
      text, [](char c) { return static_cast<unsigned char>(c) < ' '; }, ' ');
  return csv_field(text);
}

}  // namespace

// All else follows the table as comments, so that readers that skip one header line find only taps.
std::string csv_export(const ExportedDesign& design) {
  std::string text = "i,b\n";
  for (int i = 0; i <= design.filter.order(); ++i) text += fmt::format("{},{}\n", i, design.filter.tap(i));
  const auto row = [&](std::string_view name, const std::string& value) {
    text += fmt::format("# {},{}\n", name, value);
  };
  row("title", csv_cell(design.result.task.title));
  row("status", std::string(to_string(design.result.status)));
  row("sample_period_s", fmt::format("{}", design.period));
  for (const CornerResult& corner : design.result.corners) {
    row("delay_samples", fmt::format("{},{}", csv_cell(corner.name), corner.delay));
    if (corner.feed_part < 1.0) row("feed_part", fmt::format("{},{}", csv_cell(corner.name), corner.feed_part));
  }
  for (const ExportedSetting& setting : design.settings())
    row("set", fmt::format("{},{},{},{}", csv_cell(setting.name), csv_cell(setting.corner), csv_cell(setting.value),
                           setting.unit));
  for (const ExportedLimit& limit : design.limits)
    row("limit", fmt::format("{},{},{},{},{},{}", limit.kind, csv_cell(limit.axis), csv_cell(limit.corner), limit.bound,
                             limit.unit, limit.used ? fmt::format("{}", *limit.used) : ""));
  row("commit", csv_cell(design.commit));
  return text;
}

}  // namespace accdec
