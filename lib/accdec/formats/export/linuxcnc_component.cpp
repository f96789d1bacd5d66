#include <fmt/format.h>

#include <accdec/formats/export/exported_design.hpp>

namespace accdec {

std::string linuxcnc_export(const ExportedDesign& design) {
  const int taps = design.filter.order() + 1;
  std::string text = fmt::format(
      "component accdec_filter \"Acc/Dec filter designed by accdec\";\n"
      "description \"\"\"One instance a joint, between joint.N.motor-pos-cmd and what follows it. Connect\n"
      "joint.N.motor-pos-fb to the unfiltered command. The comments of the source give title, limits and the delays\n"
      "of the corners.\"\"\";\n"
      "pin in float in \"position command\";\n"
      "pin in bit load \"true: the output follows the command at once, for homing and while the machine is off\";\n"
      "pin out float out \"filtered position command\";\n"
      "variable double history[{}];\nvariable int newest;\nvariable int filled;\n"
      "function _ \"call it once a servo period\";\nlicense \"GPL\";\n;;\n",
      taps);
  text += "/* Built by: halcompile --install accdec_filter.comp\n";
  for (const std::string& fact : design.facts()) text += "   " + ascii_line(fact) + "\n";
  for (const CornerResult& corner : design.result.corners)
    text += ascii_line(fmt::format("   delay: {} samples at corner {}", corner.delay, corner.name)) + "\n";
  text += fmt::format("*/\nstatic const double taps[{}] = {{\n", taps);
  for (int i = 0; i < taps; ++i) text += fmt::format("    {:.17e}{}\n", design.filter.tap(i), i + 1 == taps ? "" : ",");
  return text + fmt::format(
                    "}};\n\nFUNCTION(_) {{\n    int i, at;\n    double sum = 0.0;\n"
                    "    if (load || !filled) {{\n        for (i = 0; i < {0}; i++) history[i] = in;\n"
                    "        filled = 1;\n    }}\n    newest = (newest + 1) % {0};\n    history[newest] = in;\n"
                    "    for (i = 0; i < {0}; i++) {{\n        at = newest - i;\n        if (at < 0) at += {0};\n"
                    "        /* Differences: at rest the output is exactly the command. */\n"
                    "        sum += taps[i] * (history[at] - in);\n    }}\n    out = in + sum;\n}}\n",
                    taps);
}

}  // namespace accdec
