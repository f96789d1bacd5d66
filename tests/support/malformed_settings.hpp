#pragma once

#include <string>
#include <vector>

#include "support/malformed_case.hpp"

namespace accdec::malformed {

/// Settings of controllers, of the table `cases`.
inline std::vector<Case> settings_cases() {
  const auto end = [](const std::string& lines) { return with_end(lines + "\n"); };  // lines from 19
  return {
      {"family_unknown", end("[design]\nfamily = \"average\""), "20:10", {"did you mean \"averages\""}},
      {"stages_too_many", end("[design]\nfamily = \"averages\"\nstages = 4"), "21:10", {"1 <= stages <= 3"}},
      {"stages_alone", end("[design]\nstages = 2"), "20:10", {"`stages` goes with `family`"}},
      {"family_and_taps", end("[design]\nfamily = [\"taps\", \"averages\"]"), "20:10", {"no setting is faster"}},
      {"taps_with_lengths",
       end("[design]\nfamily = \"taps\"\nlength_max_ms = 3"),
       "21:17",
       {"`length_max_ms` is of no use with free taps"}},
      {"length_step_odd",
       end("[design]\nfamily = \"averages\"\nlength_step_ms = 1.5"),
       "21:18",
       {"1.5 ms is no multiple of the sample period, 1 ms", "allowed are 1, 2 ms"}},
      {"length_step_nan", end("[design]\nfamily = \"averages\"\nlength_step_ms = nan"), "21:18", {"length_step_ms"}},
      {"length_cap_short",
       end("[design]\nfamily = \"averages\"\nlength_step_ms = 4\nlength_max_ms = 3"),
       "22:17",
       {"leaves stage 1 no length", "the shortest is 4 ms"}},
      {"length_caps_three",
       end("[design]\nfamily = \"averages\"\nstages = 2\nlength_max_ms = [3, 4, 5]"),
       "22:17",
       {"3 numbers for 2 stages"}},
      {"length_set_and_step",
       end("[design]\nfamily = \"averages\"\nlength_step_ms = 4\nlength_set_ms = [4, 8]"),
       "21:18",
       {"both given"}},
      {"length_set_odd",
       end("[design]\nfamily = \"averages\"\nlength_set_ms = [1, 2.25]"),
       "21:21",
       {"2.25 ms is no multiple"}},
      {"shaper_alone", end("[design]\nfamily = \"averages\"\nshaper = \"zv\""), "21:10", {"family = \"shaper\""}},
      {"pole_symmetric",
       end("[design]\nfamily = \"one-pole\"\nsymmetric = true"),
       "21:13",
       {"family = \"one-pole\", whose taps fall"}},
      {"exponential_symmetric",
       end("[design]\nfamily = [\"averages\", \"exponential\"]\nsymmetric = true"),
       "21:13",
       {"family = \"exponential\", whose taps fall"}},
      {"alpha_step_alone", end("[design]\nalpha_step = 0.1"), "20:14", {"`alpha_step` goes with `family`"}},
      {"alpha_step_without_gaussian",
       end("[design]\nfamily = \"exponential\"\nalpha_step = 0.1"),
       "21:14",
       {"it goes with family = \"gaussian\""}},
      {"alpha_step_zero",
       end("[design]\nfamily = \"gaussian\"\nalpha_step = 0"),
       "21:14",
       {"`alpha_step` = 0", "0.0006 <= alpha_step <= 6"}},
      {"time_constant_step_small",
       end("[design]\nfamily = \"exponential\"\ntime_constant_step_ms = 0.01"),
       "21:25",
       {"below a tenth of the sample period", "the least is 0.1"}},
      {"cutoff_step_small",
       end("[design]\nfamily = \"windowed-sinc\"\ncutoff_step_Hz = 0.01"),
       "21:18",
       {"more than 10000 frequencies up to 500 Hz", "the least is 0.05"}},
      {"cutoff_step_nan",
       end("[design]\nfamily = \"windowed-sinc\"\ncutoff_step_Hz = nan"),
       "21:18",
       {"cutoff_step_Hz"}},
      {"cutoff_step_with_taps", end("[design]\nfamily = \"taps\"\ncutoff_step_Hz = 1"), "21:18", {"cutoff_step_Hz"}},
      {"shaper_unknown", end("[design]\nfamily = \"shaper\"\nshaper = \"mvz\""), "21:10", {"did you mean \"mzv\"?"}},
      {"delays_unknown", end("[controller]\ndelays = \"inposition\""), "20:10", {"did you mean \"in-position\""}},
      {"delays_alone", end("[controller]\ndelays = \"in-position\""), "20:10", {"without a family"}},
      {"delays_and_samples",
       end("[design]\nfamily = \"averages\"\n[controller]\ndelays = \"exact-stop\""),
       "18:17",
       {"`delay_samples` contradicts [controller] delays"}},
  };
}

}  // namespace accdec::malformed
