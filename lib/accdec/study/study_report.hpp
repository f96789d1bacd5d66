#pragma once

#include <string>
#include <vector>

#include <accdec/files/output_file.hpp>
#include <accdec/plot/figure.hpp>
#include <accdec/study/row_store.hpp>
#include <accdec/study/study_file.hpp>
#include <accdec/study/study_table.hpp>

namespace accdec {

/// One figure of a study as something to draw. In draw_study_figure.cpp.
Figure make_study_figure(const StudyFigure& figure, const StudyTable& table);

/// Writes every file of a finished study except its manifest. These are rows.jsonl, rows.csv, NAME.svg and NAME.png of
/// each figure, and report.html, which contains the figures and has no links. Their content depends only on the study
/// and the rows.
/// @param rows  one row per point
/// @param empty  if not null, receives the names of figures that have nothing to draw
/// @return the files, closed but not yet renamed to their names
std::vector<OutputFile> write_study(const Study& study, study::RowStore& rows, const std::string& folder,
                                    std::vector<std::string>* empty = nullptr);

}  // namespace accdec
