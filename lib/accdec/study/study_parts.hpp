#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <toml++/toml.h>

#include <accdec/files/toml_table.hpp>
#include <accdec/study/study_file.hpp>

// Internal to this folder: the steps of reading a study, one file each.

namespace accdec {

/// Places in the file of a study, for errors that show only when points are made.
struct StudyPlaces {
  std::string path;
  std::vector<std::string> names;               ///< of the cases
  std::vector<toml::table> bases;               ///< their tasks before variations
  std::vector<toml::source_position> settings;  ///< where their `set` stands
  std::vector<study::Variation> variations;
  std::vector<toml::source_position> keys;  ///< where the variations' `key` stands
};

/// @throws InputError at a table's key unless the study has a column of that name
void check_column(const toml_input::Table& table, std::string_view key, const std::string& name, const Study& study);

/// Reads every [[figure]] into a study whose columns are known. In study_figure_reader.cpp.
void read_figures(const toml_input::Table& top, Study& study, bool grid);

/// Reports a mistake that makes every point bad now, at its place; see read_study for the rule. In study_points.cpp.
/// @throws InputError
void check_points(const Study& study, const Study::Tasks& tasks, const StudyPlaces& places);

}  // namespace accdec
