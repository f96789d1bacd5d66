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

/// Writes every file of a finished study but its manifest: rows.jsonl, rows.csv, NAME.svg and NAME.png of each figure,
/// and report.html with the figures inside and nothing linked. What they hold is a function of study and rows alone.
/// @param rows   one of every point
/// @param empty  receives the names of figures that have nothing to draw, unless null
/// @return the files, closed but not yet under their names
std::vector<OutputFile> write_study(const Study& study, study::RowStore& rows, const std::string& folder,
                                    std::vector<std::string>* empty = nullptr);

}  // namespace accdec
