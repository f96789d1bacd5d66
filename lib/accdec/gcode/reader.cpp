#include <accdec/gcode/canonical_call.hpp>
#include <accdec/gcode/move_sink.hpp>
#include <accdec/gcode/read_formats.hpp>
#include <accdec/simulate.hpp>

namespace accdec {

ProgramFormat read_program(LineSource& source, const ReadOptions& options, MoveSink& sink) {
  if (source.name().ends_with(".csv") || source.name().ends_with(".CSV")) {
    read_csv(source, options, sink);
    return ProgramFormat::csv;
  }
  std::string_view line;
  while (source.next(line)) {
    if (line.find_first_not_of(" \t") == std::string_view::npos) continue;
    source.again();
    // Words before a comment look like a call, T1M6(DRILL), so only the names decide. No word has a '_', so a misspelt
    // call is reported as a call.
    const std::string_view name = find_call(line).name;
    if (call_kind(name) == CallKind::unknown && name.find('_') == std::string_view::npos) break;
    read_canonical(source, options, sink);
    return ProgramFormat::canonical;
  }
  read_rs274(source, options, sink);
  return ProgramFormat::rs274;
}

}  // namespace accdec
