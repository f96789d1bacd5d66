#pragma once

#include <optional>
#include <ostream>
#include <string_view>

namespace accdec {

/// Kinds of generated programs, RS-274 in millimetres.
enum class GeneratedProgram {
  pocket,     ///< rectangular pocket cleared by offset contours with rounded corners, in levels
  zigzag,     ///< a line that turns by 30 to 150 degrees, left and right, after every 10 mm
  trochoid,   ///< a slot milled in circles that advance
  engraving,  ///< text in strokes, with rapid moves between them
  raster,     ///< rows of short segments over a wavy surface
  star,       ///< a closed fan that meets every angle from 1 to 179 degrees
  hilbert,    ///< a plane-filling curve in blocks of 1 mm
  relief,     ///< rows over a carved surface in three dimensions, blocks of about 1 mm
  spiral      ///< from the middle outwards in chords of about 1 mm
};
/// "pocket", "zigzag", "trochoid", "engraving", "raster", "star", "hilbert", "relief", "spiral".
std::string_view to_string(GeneratedProgram kind);
std::optional<GeneratedProgram> generated_program_from_string(std::string_view name);

struct GenerateOptions {
  long blocks = 1000;       ///< about this many, >= 10; the pattern continues until there are that many
  double feed = 3000.0;     ///< mm/min, > 0
  double tolerance = 0.05;  ///< mm, of G64 P, > 0
};

/// Writes a program, the same one for the same options. Nothing is kept in memory.
/// @throws std::invalid_argument for options out of range.
void generate_program(GeneratedProgram kind, const GenerateOptions& options, std::ostream& out);

}  // namespace accdec
