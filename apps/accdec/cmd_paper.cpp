#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <accdec/files/output_files.hpp>
#include <accdec/files/results_folder.hpp>
#include <accdec/files/shown_text.hpp>
#include <accdec/paper/paper_report.hpp>
#include <accdec/paper/paper_tables.hpp>

#include "command.hpp"

namespace accdec::cli {

void add_paper(CLI::App& app, Context& context) {
  const auto folder = std::make_shared<std::string>("results/paper");
  CLI::App* command =
      app.add_subcommand("paper", "Make every table and figure of the paper, beside the printed values");
  command->add_option("--out", *folder, "Folder for CSV, SVG, report.md and manifest.json")
      ->type_name("DIR")
      ->capture_default_str();
  command->callback([folder, &context] {
    require_results_folder(*folder, {"accdec.manifest/1", "command", "results of the paper", "accdec paper "});
    const std::vector<paper::Table> tables{paper::table1(), paper::table2()};
    auto files = paper::files(tables, "accdec paper --out " + *folder, ACCDEC_VERSION);
    // The manifest comes first, so that the folder is recognised even if this ends between two files.
    std::rotate(files.begin(), files.end() - 1, files.end());
    create_results_folder(*folder);
    OutputFiles output;
    for (const auto& [name, content] : files) output.add((std::filesystem::path(*folder) / name).string(), content);
    output.commit();
    int wrong = 0;
    for (const paper::Table& table : tables) wrong += table.disagreements();
    if (!context.quiet) std::fputs(paper::tables_text(tables).c_str(), stdout);
    if (!context.quiet) std::printf("figures, numbers and report: %s\n", printable(*folder).c_str());
    if (wrong > 0) std::fprintf(stderr, "%d entries of the paper's tables do not agree\n", wrong);
    context.exit_code = wrong > 0 ? exit_no_answer : exit_ok;
  });
}

}  // namespace accdec::cli
