#pragma once

#include "support/malformed_tasks.hpp"

namespace accdec::malformed {

/// Faults in dry friction, in limits of the supply that axes share, in force-speed curves, in ratings, in rotary axes
/// and in modes of axes.
inline std::vector<Case> load_cases() {
  const auto axis = [](const std::string& lines) { return with_axis("[[axis]]\n" + lines + "\n"); };  // lines from 7
  const auto curve = [&](const std::string& points) { return axis("mass_kg = 30\nforce_speed_N = " + points); };
  const auto mode = [](const std::string& lines) {
    return with_end("[[mode]]\nfrequency_Hz = 40\n" + lines + "\n");  // lines from 22
  };
  return {
      {"friction_negative", axis("coulomb_N = -40"), "7:13", {"0 <= coulomb_N"}},
      {"friction_nan", axis("coulomb_N = nan"), "7:13", {"must be finite"}},
      {"friction_in_words", axis("coulomb_N = \"40\""), "7:13", {"must be a number"}},
      {"friction_above_force",
       axis("mass_kg = 30\nforce_max_N = 50\ncoulomb_N = 60"),
       "9:13",
       {"not below `force_max_N` = 50", "could never move"}},
      {"friction_above_curve",
       axis("mass_kg = 30\nforce_speed_N = [[0, 50], [100, 30]]\ncoulomb_N = 60"),
       "9:13",
       {"not below `force_speed_N` = 50", "could never move"}},
      {"friction_above_torque",
       Parts{
           .axis = "[[axis]]\nname = \"a\"\ninertia_kg_m2 = 1\ntorque_max_N_m = 5\ncoulomb_N_m = 6\n",
           .corner = "[[corner]]\ndirection_in = [1]\ndirection_out = [-1]\nfeed_in_mm_min = 6000\ndelay_samples = 3\n"}
           .str(),
       "10:15",
       {"`coulomb_N_m` = 6 is not below `torque_max_N_m` = 5"}},
      {"friction_of_the_machine", with_end("[machine]\ncoulomb_N = 40\n"), "20:1", {"belongs in [[axis]]"}},
      {"supply_zero", with_end("[machine]\npower_total_max_W = 0\n"), "20:21", {"0 < power_total_max_W"}},
      {"supply_misspelt", with_end("[machine]\npower_total_W = 9\n"), "20:1", {"known here: power_total_max_W"}},
      {"supply_without_load",
       Parts{.axis = "[[axis]]\n", .end = "[machine]\nregeneration_total_max_W = 50\n"}.str(),
       "14:28",
       {"can never bind", "mass_kg, damping_N_s_m or coulomb_N"}},
      {"curve_number", curve("500"), "8:17", {"array of numbers"}},
      {"curve_flat_list", curve("[0, 500]"), "8:18", {"must be a pair of numbers", "an integer"}},
      {"curve_of_three", curve("[[0, 500, 1], [100, 300]]"), "8:18", {"must be a pair of numbers", "3 elements"}},
      {"curve_of_one", curve("[[0, 500]]"), "8:17", {"has 1 pairs", "2 to 100"}},
      {"curve_in_words", curve("[[0, \"x\"], [100, 300]]"), "8:22", {"must be a number"}},
      {"curve_negative", curve("[[0, 500], [100, -3]]"), "8:34", {"0 <= force_speed_N"}},
      {"curve_nan", curve("[[0, 500], [nan, 3]]"), "8:29", {"must be finite"}},
      {"curve_speeds_fall", curve("[[100, 500], [50, 300]]"), "8:30", {"speeds must rise"}},
      {"curve_forces_rise", curve("[[0, 500], [50, 600]]"), "8:28", {"forces must not rise"}},
      {"curve_of_no_force", curve("[[0, 0], [50, 0]]"), "8:18", {"begins without any force"}},
      {"curve_convex",
       curve("[[0, 500], [100, 250], [200, 125]]"),
       "8:28",
       {"falls less behind 100 mm/s", "`power_max_W` beside `force_max_N`"}},
      {"curve_without_load", axis("force_speed_N = [[0, 500], [100, 300]]"), "7:17", {"can never bind", "mass_kg"}},
      {"mode_of_no_axis", mode("axis = \"q\"\nresidual_max_um = 5"), "21:8", {"no axis of the task", "x, y"}},
      {"mode_of_axis_unnamed", mode("residual_max_um = 5"), "21:19", {"name it by `axis`"}},
      {"mode_with_axis_alone", mode("axis = \"x\"\nresidual_max = 0.1"), "21:8", {"goes with `residual_max_um`"}},
      {"mode_with_both", mode("axis = \"x\"\nresidual_max = 0.1\nresidual_max_um = 5"), "19:1", {"has both"}},
      {"mode_um_zero", mode("axis = \"x\"\nresidual_max_um = 0"), "22:19", {"0 < residual_max_um"}},
      {"rating_zero", axis("mass_kg = 30\nforce_rms_N = 0"), "8:15", {"0 < force_rms_N"}},
      {"rating_in_words", axis("mass_kg = 30\nforce_rms_N = \"60\""), "8:15", {"must be a number"}},
      {"rating_without_load", axis("force_rms_N = 60"), "7:15", {"can never bind", "mass_kg"}},
      {"rating_of_the_machine", with_end("[machine]\nforce_rms_N = 60\n"), "20:1", {"belongs in [[axis]]"}},
      {"rotary_of_a_linear_axis",
       axis("velocity_max_deg_s = 60"),
       "7:22",
       {"`velocity_max_deg_s` is for rotary axes", "a, b and c"}},
      {"rotary_in_both_units",
       axis("name = \"a\"\njerk_max_mm_s3 = 5000\njerk_max_deg_s3 = 5000"),
       "9:19",
       {"both given", "allowed is either"}},
      {"rotary_negative", axis("name = \"a\"\ninertia_kg_m2 = -1"), "8:17", {"0 <= inertia_kg_m2"}},
      {"torque_without_inertia",
       axis("name = \"a\"\ntorque_max_N_m = 5"),
       "8:18",
       {"can never bind", "give inertia_kg_m2"}},
      {"torque_rating_alone", axis("name = \"a\"\ntorque_rms_N_m = 5"), "8:18", {"can never bind", "coulomb_N_m"}},
      {"torque_of_a_linear_axis", axis("coulomb_N_m = 1"), "7:15", {"is for rotary axes"}},
      {"rotary_for_all_axes",
       axis("name = \"a\"\nvelocity_max_deg_s = 600"),
       "8:22",
       {"the only [[axis]] stands for all axes"}},
      {"damping_in_both_units",
       axis("name = \"a\"\ndamping_N_s_m = 5\ndamping_N_m_s = 5"),
       "9:17",
       {"both given", "allowed is either"}},
      {"contour_of_programs_negative", with_end("[program]\ncontour_max_um = -1\n"), "20:18", {"0 <= contour_max_um"}},
      {"contour_of_programs_in_words", with_end("[program]\ncontour_max_um = \"30\"\n"), "20:18", {"must be a number"}},
      {"contour_of_programs_tiny", with_end("[program]\ncontour_max_um = 1e-9\n"), "20:18", {"less than a simulation"}},
      {"unit_zero", with_end("[controller]\nposition_unit_um = 0\n"), "20:20", {"0 < position_unit_um"}},
      {"unit_in_words", with_end("[controller]\nposition_unit_um = \"1\"\n"), "20:20", {"must be a number"}},
      {"unit_of_the_machine", with_end("[machine]\nposition_unit_um = 1\n"), "20:1", {"belongs in [controller]"}},
      {"supply_of_an_axis", axis("power_total_max_W = 900"), "7:1", {"belongs in [machine]"}},
  };
}

}  // namespace accdec::malformed
