#pragma once

#include <string>
#include <utility>
#include <vector>

#include <accdec/paper/paper_tables.hpp>

namespace accdec::paper {

/// Both tables beside the printed numbers, for people, in plain text.
std::string tables_text(const std::vector<Table>& tables);
/// Both tables as CSV: table, v1, v2, dT, printed, recomputed by formula and by simulation, agreement.
std::string tables_csv(const Table& table);
/// The report in Markdown: tables, recovered conditions, errata, figures, the discrepancy of Fig. 12, and which claims
/// of the paper hold.
std::string report(const std::vector<Table>& tables);

/// Every file `accdec paper` writes: name and content. Needs gnuplot. `command` and `version` go only into
/// manifest.json.
std::vector<std::pair<std::string, std::string>> files(const std::vector<Table>& tables, const std::string& command,
                                                       const std::string& version);

}  // namespace accdec::paper
