#include <filesystem>

#include <fmt/format.h>

#include <accdec/plot/html.hpp>
#include <accdec/study/study_page.hpp>
#include <accdec/study/study_report.hpp>

namespace accdec {
namespace {

/// Writes both tables in one pass over the rows, without all rows in memory.
void write_rows(StudyTable& table, study::RowStore& rows, const std::string& folder, std::vector<OutputFile>& files) {
  const std::filesystem::path path = folder;
  OutputFile jsonl((path / "rows.jsonl").string()), csv((path / "rows.csv").string());
  csv.write(table.csv_head());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::string_view row = rows.row(i);
    jsonl.write(row);
    jsonl.write("\n");
    csv.write(table.take(row));
  }
  for (OutputFile* file : {&jsonl, &csv}) {
    file->close();
    files.push_back(std::move(*file));
  }
}

std::string rows_heading(const StudyTable& table) {
  if (table.size() <= StudyTable::rows_shown)
    return "<p>A click on a heading sorts by it. The same rows stand in rows.csv and rows.jsonl.</p>\n";
  return fmt::format(
      "<p>The first {} of {} rows; all stand in rows.csv and rows.jsonl. A click on a heading sorts by it.</p>\n",
      StudyTable::rows_shown, table.size());
}

}  // namespace

std::vector<OutputFile> write_study(const Study& study, study::RowStore& rows, const std::string& folder,
                                    std::vector<std::string>* empty) {
  std::vector<OutputFile> files;
  StudyTable table(study);
  write_rows(table, rows, folder, files);
  const auto write = [&](const std::string& name, std::string_view content) {
    files.emplace_back((std::filesystem::path(folder) / name).string()).write(content);
    files.back().close();
  };

  const std::size_t bad = rows.count_unanswered();
  std::string html = html_head(study.title);
  html += study_answer(study, table);
  html += fmt::format("<p>{} points{}.</p>\n", table.size(),
                      bad == 0 ? "" : fmt::format(", {} of them without an answer (column <code>reason</code>)", bad));
  if (!study.notes.empty()) html += html_paragraph(study.notes);
  for (const StudyFigure& f : study.figures) {
    const Figure figure = make_study_figure(f, table);
    if (empty && !has_data(figure.panels.front())) empty->push_back(f.name);
    const std::string svg = render_svg(figure);
    html += html_figure(f.name, figure, svg);
    write(f.name + ".png", convert_svg(svg, "png"));
    write(f.name + ".svg", svg);
  }
  html += "<h2>Outcomes</h2>\n" + study_outcomes(study, table);
  html += "<h2>What was varied</h2>\n" + study_variations(study);
  html += "<h2>The base task and its limits</h2>\n" + study_base(study);
  html += "<h2>Rows</h2>\n" + rows_heading(table) + study_rows(table);
  html += "<p>How it was made stands in manifest.json.</p>\n";
  write("report.html", html + html_foot());
  return files;
}

}  // namespace accdec
