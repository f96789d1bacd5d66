#pragma once

#include "support/malformed_tasks.hpp"

namespace accdec::malformed {

/// Faults in dry friction and in limits of the supply that axes share.
inline std::vector<Case> load_cases() {
  const auto axis = [](const std::string& lines) { return with_axis("[[axis]]\n" + lines + "\n"); };  // lines from 7
  return {
      {"friction_negative", axis("coulomb_N = -40"), "7:13", {"0 <= coulomb_N"}},
      {"friction_nan", axis("coulomb_N = nan"), "7:13", {"must be finite"}},
      {"friction_in_words", axis("coulomb_N = \"40\""), "7:13", {"must be a number"}},
      {"friction_above_force",
       axis("mass_kg = 30\nforce_max_N = 50\ncoulomb_N = 60"),
       "9:13",
       {"not below `force_max_N` = 50", "could never move"}},
      {"friction_of_the_machine", with_end("[machine]\ncoulomb_N = 40\n"), "20:1", {"belongs in [[axis]]"}},
      {"supply_zero", with_end("[machine]\npower_total_max_W = 0\n"), "20:21", {"0 < power_total_max_W"}},
      {"supply_misspelt", with_end("[machine]\npower_total_W = 9\n"), "20:1", {"known here: power_total_max_W"}},
      {"supply_without_load",
       Parts{.axis = "[[axis]]\n", .end = "[machine]\nregeneration_total_max_W = 50\n"}.str(),
       "14:28",
       {"can never bind", "mass_kg, damping_N_s_m or coulomb_N"}},
      {"supply_of_an_axis", axis("power_total_max_W = 900"), "7:1", {"belongs in [machine]"}},
  };
}

}  // namespace accdec::malformed
