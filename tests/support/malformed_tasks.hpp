#pragma once

#include <ostream>
#include <string>
#include <vector>

namespace accdec::malformed {

/// A task file with one thing wrong, and what the message must begin with (after the file's name) and contain.
struct Case {
  const char* name;
  std::string text;
  std::string position;  ///< "line:column"
  std::vector<std::string> words;
};
inline void PrintTo(const Case& c, std::ostream* out) {
  *out << c.name;
}

/// A correct task; cases put their fault in one place of it. Lines: 1 sample period, 2-5 filter, 6-12 axis, 13-18
/// corner.
struct Parts {
  std::string top = "sample_period_ms = 1.0\n";
  std::string filter = "[filter]\nkind = \"trapezoid\"\norder = 20\nramp = 5\n";
  std::string axis =
      "[[axis]]\nname = \"x\"\nvelocity_max_mm_s = 500\nacceleration_max_mm_s2 = 9000\nmass_kg = 50\ndamping_N_s_m = "
      "10\nforce_max_N = 600\n";
  std::string corner =
      "[[corner]]\nname = \"A\"\nangle_deg = 95\nfeed_in_mm_min = 6000\nerror_max_um = 400\ndelay_samples = 3\n";
  std::string end = "";
  std::string str() const { return top + filter + axis + corner + end; }
};
inline std::string with_top(std::string s) {
  return Parts{.top = std::move(s)}.str();
}
inline std::string with_filter(std::string s) {
  return Parts{.filter = std::move(s)}.str();
}
inline std::string with_axis(std::string s) {
  return Parts{.axis = std::move(s)}.str();
}
inline std::string with_corner(std::string s) {
  return Parts{.corner = std::move(s)}.str();
}
inline std::string with_end(std::string s) {
  return Parts{.end = std::move(s)}.str();
}

inline const std::string corner_head =
    "[[corner]]\nangle_deg = 90\nfeed_in_mm_min = 6000\ndelay_samples = 0\n";  // lines 13-16

/// Every message names what is wrong and, in the words checked, what is allowed. One table, as long as it is: a case is
/// a few lines of it.
inline std::vector<Case> cases() {
  const auto filter = [](const std::string& lines) {
    return with_filter("[filter]\n" + lines + "\n");
  };  // lines from 3
  const auto corner = [](const std::string& lines) {
    return with_corner(corner_head + lines + "\n");
  };                                                                                                  // lines from 17
  const auto axis = [](const std::string& lines) { return with_axis("[[axis]]\n" + lines + "\n"); };  // lines from 7
  const auto end = [](const std::string& lines) { return with_end(lines + "\n"); };                   // lines from 19
  return {
      // Structure of the file
      {"empty", "", "1:1", {"empty", "sample_period_ms", "[[corner]]"}},
      {"only_blanks", " \n\n\t\n", "1:1", {"empty"}},
      {"only_comment", "# nothing\n", "1:1", {"needs `sample_period_ms`", "0.0001 <= sample_period_ms <= 1000"}},
      {"syntax", "sample_period_ms = \n", "1:20", {"not valid TOML"}},
      {"open_string", "title = \"abc\nsample_period_ms = 1\n", "1:13", {"not valid TOML"}},
      {"no_quotes", with_filter("[filter]\nkind = boxcar\norder = 4\n"), "3:8", {"not valid TOML"}},
      {"key_twice",
       with_top("sample_period_ms = 1\nsample_period_ms = 2\n"),
       "2:20",
       {"not valid TOML", "sample_period_ms"}},
      {"garbage",
       "\x7f"
       "ELF\x02\x01\x01",
       "1:1",
       {"not valid TOML"}},
      {"bad_utf8", "title = \"\xC3\x28\"\n", "1:9", {"not valid TOML"}},
      // Tables
      {"no_corner", Parts{.corner = ""}.str(), "1:1", {"no corner", "[[corner]]"}},
      {"corner_single", with_corner("[corner]\nangle_deg = 90\n"), "13:1", {"write [[corner]], not [corner]"}},
      {"axis_single", with_axis("[axis]\nmass_kg = 3\n"), "6:1", {"write [[axis]], not [axis]"}},
      {"filter_list", with_filter("[[filter]]\nkind = \"boxcar\"\n"), "2:1", {"write [filter], once"}},
      {"filter_number",
       with_top("filter = 3\nsample_period_ms = 1\n").substr(0, 32),
       "1:10",
       {"`filter` must be a table [filter]", "an integer"}},
      {"corner_numbers",
       "sample_period_ms = 1\ncorner = [1, 2]\n",
       "2:11",
       {"must hold tables [[corner]] only", "an integer"}},
      {"unknown_table", end("[engine]\nx = 1"), "19:2", {"unknown key `engine`", "known here:", "axis"}},
      {"table_typo", end("[desing]\norder_min = 3"), "19:2", {"unknown key `desing`", "did you mean `design`?"}},
      {"ten_axes",
       with_axis([] {
         std::string s;
         for (int i = 0; i < 10; ++i) s += "[[axis]]\nname = \"q" + std::to_string(i) + "\"\n";
         return s;
       }()),
       "24:1",
       {"10 [[axis]] tables", "at most 9"}},
      // Unknown keys and suggestions
      {"typo", corner("eror_max_um = 5"), "17:1", {"unknown key `eror_max_um`", "did you mean `error_max_um`?"}},
      {"swap", corner("wieght = 5"), "17:1", {"did you mean `weight`?"}},
      {"unit_mm", corner("error_max_mm = 0.1"), "17:1", {"did you mean `error_max_um`?"}},
      {"unit_m_s2", axis("acceleration_max_m_s2 = 6"), "7:1", {"did you mean `acceleration_max_mm_s2`?"}},
      {"unit_s", with_top("sample_period_s = 0.001\n"), "1:1", {"did you mean `sample_period_ms`?"}},
      {"unit_missing", with_corner("[[corner]]\nangle = 90\n"), "14:1", {"did you mean `angle_deg`?"}},
      {"upper_case", axis("Force_Max_n = 3"), "7:1", {"did you mean `force_max_N`?"}},
      {"hyphen", corner("speed-min-mm-s = 3"), "17:1", {"did you mean `speed_min_mm_s`?"}},
      {"prefix", with_corner("[[corner]]\nangle_deg = 90\ndelay = 3\n"), "15:1", {"did you mean `delay_samples`?"}},
      {"other_table", axis("feed_in_mm_min = 6000"), "7:1", {"`feed_in_mm_min` belongs in [[corner]]"}},
      {"below_header", with_top("") + "sample_period_ms = 1\n", "1:1", {"needs `sample_period_ms`"}},
      {"late_top_key", end("sample_period_ms = 2"), "19:1", {"`sample_period_ms` belongs at the top"}},
      {"mass_in_corner", corner("mass_kg = 2"), "17:1", {"`mass_kg` belongs in [[axis]]"}},
      {"nonsense_key", corner("xyzzy = 5"), "17:1", {"unknown key `xyzzy`", "known here:", "error_max_um"}},
      // Types
      {"period_string", with_top("sample_period_ms = \"1\"\n"), "1:20", {"must be a number", "a string"}},
      {"period_bool", with_top("sample_period_ms = true\n"), "1:20", {"must be a number", "a boolean"}},
      {"period_date", with_top("sample_period_ms = 2020-01-01\n"), "1:20", {"must be a number", "a date or time"}},
      {"title_number", with_top("title = 3\nsample_period_ms = 1\n"), "1:9", {"must be a string", "an integer"}},
      {"order_fraction",
       filter("kind = \"boxcar\"\norder = 1.5"),
       "4:9",
       {"must be a whole number", "0 <= order <= 1000000"}},
      {"delay_fraction",
       with_corner("[[corner]]\nangle_deg = 90\nfeed_in_mm_min = 6000\ndelay_samples = 2.5\n"),
       "16:17",
       {"must be a whole number"}},
      {"symmetric_number", end("[design]\nsymmetric = 1"), "20:13", {"must be true or false"}},
      {"taps_number", filter("kind = \"taps\"\ntaps = 3"), "4:8", {"must be an array of numbers"}},
      {"taps_element",
       filter("kind = \"taps\"\ntaps = [1, \"2\", 3]"),
       "4:12",
       {"element 1 must be a number", "a string"}},
      {"frequency_string",
       end("[[mode]]\nfrequency_Hz = \"40\"\nresidual_max = 0.1"),
       "20:16",
       {"a number or an array of numbers"}},
      // Numbers
      {"period_nan",
       with_top("sample_period_ms = nan\n"),
       "1:20",
       {"must be finite", "0.0001 <= sample_period_ms <= 1000"}},
      {"feed_inf", with_corner("[[corner]]\nangle_deg = 90\nfeed_in_mm_min = inf\n"), "15:18", {"must be finite"}},
      {"mass_minus_inf", axis("mass_kg = -inf"), "7:11", {"must be finite"}},
      {"period_zero",
       with_top("sample_period_ms = 0\n"),
       "1:20",
       {"out of range", "0.0001 <= sample_period_ms <= 1000"}},
      {"error_below_rounding",
       with_corner(corner_head + "error_max_um = 1e-7\n"),
       "17:16",
       {"error_max_um = 1e-07 is less than a simulation can tell from 0", "allowed is 0 or 1e-06 and more"}},
      {"unit_of_the_limit",
       with_axis("[[axis]]\nacceleration_max_m_s2 = 9\n"),
       "7:1",
       {"did you mean `acceleration_max_mm_s2`? Its number is in mm/s^2, not in m/s^2"}},
      {"nested_too_deep",
       with_top("a" +
                [] {
                  std::string dots;
                  for (int i = 0; i < 50'000; ++i) dots += ".a";
                  return dots;
                }() +
                " = 1\n"),
       "1:128",
       {"nest more than 64 deep"}},
      {"period_long", with_top("sample_period_ms = 1001\n"), "1:20", {"= 1001 is out of range", "<= 1000"}},
      {"angle_zero",
       with_corner("[[corner]]\nangle_deg = 0\nfeed_in_mm_min = 1\n"),
       "14:13",
       {"= 0 is out of range", "0 < angle_deg <= 180"}},
      {"angle_wide",
       with_corner("[[corner]]\nangle_deg = 190\nfeed_in_mm_min = 1\n"),
       "14:13",
       {"= 190 is out of range", "0 < angle_deg <= 180"}},
      {"angle_negative", with_corner("[[corner]]\nangle_deg = -90\nfeed_in_mm_min = 1\n"), "14:13", {"out of range"}},
      {"feed_zero",
       with_corner("[[corner]]\nangle_deg = 90\nfeed_in_mm_min = 0\n"),
       "15:18",
       {"0 < feed_in_mm_min <= 10000000"}},
      {"feed_absurd",
       with_corner("[[corner]]\nangle_deg = 90\nfeed_in_mm_min = 2e7\n"),
       "15:18",
       {"out of range", "<= 10000000"}},
      {"error_negative", corner("error_max_um = -1"), "17:16", {"0 <= error_max_um"}},
      {"delay_negative",
       with_corner("[[corner]]\nangle_deg = 90\nfeed_in_mm_min = 6000\ndelay_samples = -1\n"),
       "16:17",
       {"0 <= delay_samples <= 1000000"}},
      {"weight_zero", corner("weight = 0"), "17:10", {"0 < weight"}},
      {"speed_negative", corner("speed_min_mm_s = -3"), "17:18", {"0 <= speed_min_mm_s"}},
      {"acceleration_zero", axis("acceleration_max_mm_s2 = 0"), "7:26", {"0 < acceleration_max_mm_s2"}},
      {"mass_negative", axis("mass_kg = -1"), "7:11", {"0 <= mass_kg"}},
      {"order_absurd", filter("kind = \"boxcar\"\norder = 2000000"), "4:9", {"out of range", "order <= 1000000"}},
      {"order_beyond_64_bit", filter("kind = \"boxcar\"\norder = 99999999999999999999"), "4:29", {"not valid TOML"}},
      {"frequency_absurd",
       end("[[mode]]\nfrequency_Hz = 2e6\nresidual_max = 0.1"),
       "20:16",
       {"0 < frequency_Hz <= 1000000"}},
      {"residual_percent", end("[[mode]]\nfrequency_Hz = 40\nresidual_max = 5"), "21:16", {"0 <= residual_max <= 1"}},
      // Filters
      {"kind_missing", filter("order = 3"), "2:1", {"needs `kind`", "blackman-sinc"}},
      {"kind_unknown",
       filter("kind = \"blackmann\"\norder = 3"),
       "3:8",
       {"\"blackmann\" is unknown", "did you mean \"blackman\"?", "boxcar"}},
      {"order_missing", filter("kind = \"hann\""), "2:1", {"needs `order`", "0 <= order <= 1000000"}},
      {"hann_short", filter("kind = \"hann\"\norder = 1"), "4:9", {"hann needs order >= 2"}},
      {"cutoff_for_boxcar",
       filter("kind = \"boxcar\"\norder = 3\ncutoff = 0.1"),
       "5:10",
       {"no meaning for kind \"boxcar\"", "\"blackman-sinc\""}},
      {"ramp_for_hann", filter("kind = \"hann\"\norder = 3\nramp = 1"), "5:8", {"no meaning", "\"trapezoid\""}},
      {"taps_for_boxcar", filter("kind = \"boxcar\"\norder = 1\ntaps = [1, 1]"), "5:8", {"no meaning", "\"taps\""}},
      {"cutoff_missing", filter("kind = \"blackman-sinc\"\norder = 40"), "2:1", {"needs `cutoff`"}},
      {"cutoff_large", filter("kind = \"blackman-sinc\"\norder = 40\ncutoff = 0.06"), "5:10", {"0 < cutoff <= 0.05"}},
      {"ramp_missing", filter("kind = \"trapezoid\"\norder = 40"), "2:1", {"needs `ramp`"}},
      {"ramp_large", filter("kind = \"trapezoid\"\norder = 20\nramp = 11"), "5:8", {"0 <= ramp <= 10"}},
      {"taps_missing", filter("kind = \"taps\""), "2:1", {"needs `taps`"}},
      {"taps_empty", filter("kind = \"taps\"\ntaps = []"), "4:8", {"has 0 numbers", "1 to 1000001"}},
      {"taps_negative",
       filter("kind = \"taps\"\ntaps = [1, -1, 3]"),
       "4:12",
       {"element 1 = -1 is out of range", "0 <= taps"}},
      {"taps_zero", filter("kind = \"taps\"\ntaps = [0, 0]"), "4:8", {"zero"}},
      {"taps_order",
       filter("kind = \"taps\"\norder = 5\ntaps = [1, 1]"),
       "4:9",
       {"does not match the 2 taps", "write 1"}},
      // Contradictions
      {"orders_crossed",
       end("[design]\norder_min = 30\norder_max = 20"),
       "20:13",
       {"`order_min` = 30 is above `order_max` = 20"}},
      {"coefficient_bits",
       end("[design]\ncoefficient_bits = 7"),
       "20:20",
       {"`coefficient_bits` = 7", "8 <= coefficient_bits <= 31"}},
      {"coefficient_bits_and_filter",
       end("[design]\ncoefficient_bits = 16"),
       "20:20",
       {"taps that are designed", "leave [filter] out"}},
      {"controller_unknown",
       end("[controller]\nname = \"fanuc-01\""),
       "20:8",
       {"unknown controller \"fanuc-01\"", "did you mean \"fanuc-0i\"?"}},
      {"order_min_default", end("[design]\norder_min = 500"), "20:13", {"`order_max` = 400", "default"}},
      // Settings of controllers
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
       {"a pole is never symmetric"}},
      {"delays_unknown", end("[controller]\ndelays = \"inposition\""), "20:10", {"did you mean \"in-position\""}},
      {"delays_alone", end("[controller]\ndelays = \"in-position\""), "20:10", {"without a family"}},
      {"delays_and_samples",
       end("[design]\nfamily = \"averages\"\n[controller]\ndelays = \"exact-stop\""),
       "18:17",
       {"`delay_samples` contradicts [controller] delays"}},
      {"corner_twice",
       end("[[corner]]\nname = \"A\"\nangle_deg = 90\nfeed_in_mm_min = 1"),
       "20:8",
       {"\"A\" is taken already (line 14)"}},
      {"corner_default_twice",
       with_corner("[[corner]]\nname = \"B\"\nangle_deg = 9\nfeed_in_mm_min = 1\n[[corner]]\nangle_deg = "
                   "9\nfeed_in_mm_min = 1\n"),
       "17:1",
       {"\"B\" is taken already (line 14)"}},
      {"axis_twice",
       with_axis("[[axis]]\nname = \"x\"\n[[axis]]\nname = \"x\"\n"),
       "9:8",
       {"\"x\" is taken already (line 7)"}},
      {"name_empty",
       with_corner("[[corner]]\nname = \"\"\nangle_deg = 90\nfeed_in_mm_min = 1\n"),
       "14:8",
       {"must not be empty"}},
      {"name_control",
       with_corner("[[corner]]\nname = \"a\\nb\"\nangle_deg = 90\nfeed_in_mm_min = 1\n"),
       "14:8",
       {"control character"}},
      {"angle_missing",
       with_corner("[[corner]]\nfeed_in_mm_min = 1\n"),
       "13:1",
       {"needs `angle_deg`", "0 < angle_deg <= 180", "direction_in"}},
      {"feed_missing", with_corner("[[corner]]\nangle_deg = 90\n"), "13:1", {"needs `feed_in_mm_min`"}},
      {"turn_unknown", corner("turn = \"up\""), "17:8", {"\"up\" is unknown", "left, right"}},
      {"angle_and_direction",
       corner("direction_in = [1, 0]\ndirection_out = [0, 1]"),
       "14:13",
       {"both given", "either"}},
      {"direction_alone",
       with_corner("[[corner]]\ndirection_in = [1, 0]\nfeed_in_mm_min = 1\n"),
       "13:1",
       {"needs `direction_out` as well"}},
      {"direction_sizes",
       with_corner("[[corner]]\ndirection_in = [1, 0]\ndirection_out = [1, 0, 1]\nfeed_in_mm_min = 1\n"),
       "15:17",
       {"has 3 numbers, `direction_in` 2"}},
      {"direction_zero",
       with_corner("[[corner]]\ndirection_in = [1, 0]\ndirection_out = [0, 0]\nfeed_in_mm_min = 1\n"),
       "15:17",
       {"zero in every axis"}},
      {"direction_ten",
       with_corner("[[corner]]\ndirection_in = [1,1,1,1,1,1,1,1,1,1]\ndirection_out = [1]\nfeed_in_mm_min = 1\n"),
       "14:16",
       {"has 10 numbers", "1 to 9"}},
      {"direction_axes",
       with_axis("[[axis]]\nname = \"x\"\n[[axis]]\nname = \"y\"\n") +
           "[[corner]]\nname = \"Q\"\ndirection_in = [1]\ndirection_out = [-1]\nfeed_in_mm_min = 1\n",
       "18:16",
       {"1 numbers for 2 axes"}},
      {"angle_one_axis",
       with_corner("[[corner]]\ndirection_in = [1]\ndirection_out = [-1]\nfeed_in_mm_min = 1\n[[corner]]\nangle_deg = "
                   "90\nfeed_in_mm_min = 1\n"),
       "18:13",
       {"needs at least 2 axes"}},
      {"gain_in_1_ms", axis("servo_gain_1_s = 0.02"), "7:18", {"1 <= servo_gain_1_s", "(m/min)/mm is 16.67 1/s"}},
      {"gain_zero", axis("servo_gain_1_s = 0"), "7:18", {"1 <= servo_gain_1_s"}},
      {"gain_negative", axis("servo_gain_1_s = -200"), "7:18", {"1 <= servo_gain_1_s"}},
      {"gain_nan", axis("servo_gain_1_s = nan"), "7:18", {"must be finite"}},
      {"gain_huge", axis("servo_gain_1_s = 1e300"), "7:18", {"servo_gain_1_s <= 10000"}},
      {"gain_in_words", axis("servo_gain_1_s = \"200\""), "7:18", {"must be a number"}},
      {"gain_too_slow_for_the_period",
       Parts{.top = "sample_period_ms = 0.001\n", .axis = "[[axis]]\nservo_gain_1_s = 1\n"}.str(),
       "7:18",
       {"settles in", "a larger gain or a longer sample period"}},
      {"feedforward_in_percent", axis("servo_gain_1_s = 200\nvelocity_feedforward = 95"), "8:24", {"95 % is 0.95"}},
      {"feedforward_negative", axis("servo_gain_1_s = 200\nvelocity_feedforward = -0.1"), "8:24", {"0 <= velocity_"}},
      {"feedforward_alone", axis("velocity_feedforward = 0.9"), "7:24", {"goes with `servo_gain_1_s`"}},
      {"response_sum", axis("response_taps = [0.5, 0.4]"), "7:17", {"sum 0.9", "allowed is 1"}},
      {"response_sum_in_percent", axis("response_taps = [10, 20]"), "7:22", {"<= response_taps <= 10"}},
      {"response_nan", axis("response_taps = [0.5, nan]"), "7:23", {"must be finite"}},
      {"response_empty", axis("response_taps = []"), "7:17", {"response_taps"}},
      {"response_and_gain",
       axis("servo_gain_1_s = 200\nresponse_taps = [1]"),
       "7:18",
       {"both given", "either the gain or the measured response"}},
      {"prefilter_sum", with_end("[controller]\nprefilter_taps = [1, 1]\n"), "20:18", {"sum 2", "allowed is 1"}},
      {"prefilter_negative",
       with_end("[controller]\nprefilter_taps = [1.0, -0.5, 0.5]\n"),
       "20:24",
       {"0 <= prefilter_taps <= 1"}},
      {"prefilter_of_an_axis", axis("prefilter_taps = [1]"), "7:1", {"belongs in [controller]"}},
      {"force_alone", axis("force_max_N = 5"), "7:15", {"can never bind", "mass_kg or damping_N_s_m"}},
      {"mode_without_frequency", end("[[mode]]\nresidual_max = 0.1"), "19:1", {"needs `frequency_Hz`", "[low, high]"}},
      {"mode_without_bound", end("[[mode]]\nfrequency_Hz = 40"), "19:1", {"needs `residual_max`"}},
      {"band_down",
       end("[[mode]]\nfrequency_Hz = [46, 38]\nresidual_max = 0.1"),
       "20:16",
       {"runs downwards", "[low, high]"}},
      {"band_three",
       end("[[mode]]\nfrequency_Hz = [1, 2, 3]\nresidual_max = 0.1"),
       "20:16",
       {"has 3 numbers", "1 to 2"}},
      {"feed_over_velocity",
       with_corner("[[corner]]\nangle_deg = 90\nfeed_in_mm_min = 40000\n"),
       "15:18",
       {"axis x", "666.667 mm/s", "velocity_max_mm_s = 500", "30000 mm/min"}},
      {"feed_out_over_velocity",
       with_corner("[[corner]]\nangle_deg = 90\nfeed_in_mm_min = 6000\nfeed_out_mm_min = 40000\n"),
       "16:19",
       {"feed_out_mm_min asks axis y"}},
      {"program_typo", end("[program]\nerror_max_mm = 1"), "20:1", {"did you mean `error_max_um`?"}},
  };
}

}  // namespace accdec::malformed
