#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Core>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <accdec/corner.hpp>
#include <accdec/files/process.hpp>
#include <accdec/filter.hpp>
#include <accdec/paper/paper_case.hpp>
#include <accdec/paper/paper_circle.hpp>
#include <accdec/paper/paper_drawings.hpp>
#include <accdec/paper/paper_report.hpp>

namespace accdec::paper {
namespace {

std::string cell(const Entry& e) {
  return fmt::format("{:.3f}", std::abs(e.formula) < 5e-4 ? 0.0 : e.formula);
}

std::string markdown(const Table& table) {
  std::string text = fmt::format(
      "### {}\n\nPrinted, and in brackets recomputed before rounding (formula; simulation agrees to the digits "
      "shown).\n\n",
      table.title);
  text += "| v₁ | v₂ |";
  for (const int d : table.delays) text += d == 0 ? " dT = 0 |" : fmt::format(" dT = {} T |", d);
  text += "\n|--:|--:|";
  for (std::size_t i = 0; i < table.delays.size(); ++i) text += "--:|";
  text += '\n';
  for (std::size_t i = 0; i < table.entries.size(); ++i) {
    const Entry& e = table.entries[i];
    if (i % table.delays.size() == 0) text += fmt::format("| {} | {} |", e.feed_in, e.feed_out);
    text += fmt::format(" {} ({}){} |", e.printed, cell(e), e.agrees() ? "" : " **differs**");
    if ((i + 1) % table.delays.size() == 0) text += '\n';
  }
  return text + "\n";
}

const Entry& nearest_tie(const std::vector<Table>& tables) {
  const Entry* nearest = nullptr;
  for (const Table& table : tables) {
    for (const Entry& e : table.entries) {
      if (nearest == nullptr || e.tie_distance() < nearest->tie_distance()) nearest = &e;
    }
  }
  return *nearest;
}

constexpr const char* conditions = R"(## Conditions the paper does not print

Recovered by recomputing its numbers; with these all entries are met.

| where | condition |
|---|---|
| Tables 1 and 2 | interior corner angle 95° |
| units | 1 BLU = 1 µm in all files here; T = 1 ms |
| Table 1 | continuous linear Acc/Dec with tau_A = 41 T, c = 3; the error is the smallest distance at the instants t = k T of the exact motion, not the minimum over all t |
| Table 2 | the lost header reads dT = 0, 5 T, 15 T, 41 T |
| Table 2, Fig. 10 and 11 | the "Blackman filter" is a Blackman-windowed sinc low-pass of order 40 with its cut-off at 0.049 of the Nyquist frequency (24.5 Hz), not the bare window; position by the right-rectangle sum of Eq. (29) |
| Fig. 12 | the same filter, c = 2, 95°; the feed "6 000 mm/sec" must be 6000 mm/min = 100 mm/s; linear Acc/Dec as in Table 1 |
| Fig. 1 to 4 | sketches without numbers: drawn here from the model at the conditions of Fig. 5, leg 1 at 60° to the x-axis |
| Fig. 5 to 8, 10 | the paper prints no numbers: drawn here at 95°, v1 = v2 = 4e5 BLU/s and, where delayed, dT = 10 T |

)";

constexpr const char* errata = R"(## Errata

| equation | printed | what it must be |
|---|---|---|
| (9), remark | off by "about 2 %" at c = 2 | right as a round figure: {:.1f} exact against {:.1f} approximate (v0 = 5e5 BLU/s, tau = 41 ms, 90°), {:.1f} % |
| (13.a) | cos(theta/2) | sin(theta/2), as in every other velocity along a |
| (20) | motion begins N/2 samples before the corner | true for symmetric taps; for others the mean delay M = sum i b_i / b_s takes the place of N/2 |
| (25.a) | c in front of the decelerating leg | c belongs to the accelerating leg: v_a = v0 sin(theta/2) (1 + (c - 1) B_k) |
| (25.b) | first form inconsistent with its result | the simplified right-hand side is right |
| (26), (29) | the sums run over j but add v[k] | they add v[j], j = 1 .. k |
| (28.b) | v_2[k] on the left | v_b[k] |
| (31), (32) | taps 1 .. N + 1 from a curve defined on 0 .. N, without the curve's scale | the scale cancels with b_s; take the quintic's derivative at N + 1 points, both zero ends included |
| Section 4.3.1 | v = 6 000 mm/sec | mm/min |
| Fig. 12 | linear Acc/Dec needs a delay of 12 T | 14 T, see below |

The window below Eq. (29), k = 1 .. N + d + 1, makes a corner last (N + 1 + d) T. A boxcar of 41 taps then takes tau_A + dT with tau_A = 41 T.

)";

std::string errata_text() {
  // The remark below Eq. (9), checked.
  const LinearCorner corner(0.5 * std::numbers::pi, 0.5, 1.0, 0.041);
  const double exact = corner.corner_error() * 1e6, approximate = corner.approximate_corner_error() * 1e6;
  return fmt::format(fmt::runtime(errata), exact, approximate, (1.0 - approximate / exact) * 100.0);
}

/// Whether the delays of Fig. 12 depend on the angle, which the paper does not print.
std::string figure12_angles() {
  std::string text =
      "The angle is not the cause: the same delays are needed at ten angles from 30° to 150°.\n\n"
      "| angle | FIR / µm | linear, 12 T / µm | linear needs | S-curve needs |\n|--:|--:|--:|--:|--:|\n";
  for (const double degrees : {30.0, 45.0, 60.0, 75.0, 90.0, 95.0, 105.0, 120.0, 135.0, 150.0}) {
    const double theta = degrees / 180.0 * std::numbers::pi;
    text +=
        fmt::format("| {:g}° | {:.1f} | {:.1f} | {} T | {} T |\n", degrees,
                    figure12_error(Processor::fir, 0, theta) * 1e6, figure12_error(Processor::linear, 12, theta) * 1e6,
                    figure12_delay(Processor::linear, theta), figure12_delay(Processor::s_curve, theta));
  }
  return text + "\n";
}

std::string figure12_text() {
  const auto um = [](Processor p, int d) { return figure12_error(p, d) * 1e6; };
  const std::string quintic = shape_title(Shape::s_curve);
  return fmt::format(
      "## Fig. 12\n\n"
      "| processor | delay | corner error / µm |\n|---|--:|--:|\n"
      "| Blackman FIR | 0 | {:.1f} |\n| {} | 0 | {:.1f} |\n| {} | 4 T | {:.1f} |\n"
      "| linear | 0 | {:.1f} |\n| linear | 12 T (printed) | {:.1f} |\n| linear | 14 T | {:.1f} |\n\n"
      "The paper delays the linear processor by 12 T and the S-curve by 4 T \"to achieve the same corner error\" as "
      "the FIR. For the S-curve "
      "that holds: the smallest sufficient delay is {} T. For the linear processor it does not: 12 T leaves {:.1f} µm "
      "where the FIR has {:.1f}, and "
      "the smallest sufficient delay is {} T. The discrepancy is the paper's; the figure shows the printed delays and "
      "marks both.\n\n"
      "{}",
      um(Processor::fir, 0), quintic, um(Processor::s_curve, 0), quintic, um(Processor::s_curve, 4),
      um(Processor::linear, 0), um(Processor::linear, 12), um(Processor::linear, 14),
      figure12_delay(Processor::s_curve), um(Processor::linear, 12), um(Processor::fir, 0),
      figure12_delay(Processor::linear), figure12_angles());
}

std::string claims_text() {
  const EqualLimits e = equal_limits();
  return fmt::format(
             "## What the paper claims and what holds\n\n"
             "*\"The FIR Acc/Dec has the smallest corner error.\"* It holds at equal Acc/Dec time, as in Fig. 12. It "
             "does not "
             "hold at equal limits. For equal "
             "feeds and symmetric taps the error is v0 T cos(theta/2) times the mean absolute deviation (MAD) of the "
             "taps (Eq. 24). So the MAD ranks filters at every corner:\n\n"
             "| filter | order | MAD / samples |\n|---|--:|--:|\n"
             "| Blackman FIR of the paper | {} | {:.3f} |\n"
             "| trapezoid with both limits used up (ramps not a whole number of samples) | {} | {:.3f} |\n"
             "| shortest trapezoid with whole-sample ramps ({} taps a ramp) | {} | {:.3f} |\n"
             "| boxcar with the same peak acceleration, jerk not limited | {} | {:.3f} |\n\n"
             "The limits are the FIR's own: largest tap {:.5f} (peak acceleration a T/v) and largest difference of "
             "neighbouring taps, both ends included, "
             "{:.5f} (peak jerk j T²/v). Within these limits tap i of any filter is at most min({:.5f}, (i + 1) "
             "{:.5f}, (N + "
             "1 - i) "
             "{:.5f}). These bounds add up to 1 only from N = {} on (sum {:.4f}), so no shorter filter exists. Scaled "
             "to sum 1 they are the trapezoid of the table. So at equal peak "
             "acceleration and jerk a filter of order {} beats the FIR of order {} both in time and in corner error "
             "({:.1f} % "
             "less). The Blackman shape is faster only if vibration, or a force or power limit that depends on speed, "
             "binds. Filters should be compared at equal limits.\n\n"
             "*\"It also provides the shortest machining time for the same accuracy.\"* It holds for the three "
             "processors of Fig. 12, which have the same N. They need 0, {} and {} samples of delay. It does not hold "
             "if the order is free: see the table.\n\n"
             "*\"Corner error is less affected with increasing c.\"* Holds (Fig. 9): the factor c/(c + 1) of Eq. (9) "
             "saturates.\n\n"
             "*\"The corner error is proportional to the velocity.\"* Holds exactly for a fixed ratio c: all rows of "
             "both "
             "tables are multiples of the last.\n\n",
             order, e.fir_mad, e.least_order, e.envelope_mad, e.trapezoid_ramp, e.trapezoid_order, e.trapezoid_mad,
             e.boxcar_order, e.boxcar_mad, e.tap_max, e.step_max, e.tap_max, e.step_max, e.step_max, e.least_order,
             e.least_sum, e.least_order, order, (1.0 - e.envelope_mad / e.fir_mad) * 100.0,
             figure12_delay(Processor::s_curve), figure12_delay(Processor::linear)) +
         circle_text();
}

std::string first_line(const std::string& text) {
  return text.substr(0, text.find('\n'));
}

}  // namespace

std::string tables_text(const std::vector<Table>& tables) {
  std::string text;
  for (const Table& table : tables) {
    text += table.title + "\n     v1    v2";
    for (const int d : table.delays) text += fmt::format("   {:>19}", fmt::format("dT = {} T", d));
    text += "\n   1e5 BLU/s ";
    for (std::size_t i = 0; i < table.delays.size(); ++i) text += fmt::format("  {:>8} {:>11}", "printed", "ours");
    text += '\n';
    for (std::size_t i = 0; i < table.entries.size(); ++i) {
      const Entry& e = table.entries[i];
      if (i % table.delays.size() == 0) text += fmt::format("  {:5} {:5}", e.feed_in, e.feed_out);
      text += fmt::format("  {:>8} {:>10.3f}{}", e.printed, e.formula + 0.0, e.agrees() ? ' ' : '!');
      if ((i + 1) % table.delays.size() == 0) {
        text.erase(text.find_last_not_of(' ') + 1);
        text += '\n';
      }
    }
    text += fmt::format("{} of {} entries agree after rounding to whole BLU\n\n",
                        table.entries.size() - static_cast<std::size_t>(table.disagreements()), table.entries.size());
  }
  return text;
}

std::string tables_csv(const Table& table) {
  std::string text = "v1_1e5_BLU_s,v2_1e5_BLU_s,dT_samples,printed_BLU,formula_BLU,simulation_BLU,agrees\n";
  for (const Entry& e : table.entries) {
    // The exact stop leaves rounding of either sign.
    const auto shown = [](double x) { return std::max(0.0, std::abs(x) < 5e-7 ? 0.0 : x); };
    text += fmt::format("{},{},{},{},{:.6f},{:.6f},{}\n", e.feed_in, e.feed_out, e.delay, e.printed, shown(e.formula),
                        shown(e.simulated), e.agrees() ? "yes" : "no");
  }
  return text;
}

std::string report(const std::vector<Table>& tables) {
  std::string text =
      "# Shih, Chen, Lee: \"Path Planning for CNC Contouring around a Corner\", recomputed\n\n"
      "Written by `accdec paper`. Every number below is computed by that command, except those marked as printed in "
      "the paper.\n\n## Tables\n\n";
  std::size_t entries = 0;
  int wrong = 0;
  for (const Table& table : tables) {
    text += markdown(table);
    entries += table.entries.size();
    wrong += table.disagreements();
  }
  const Entry& tie = nearest_tie(tables);
  text += fmt::format(
      "{} of {} entries equal the printed ones after rounding to whole BLU, by the formulas and by plain convolution "
      "of the command stream alike. "
      "No entry is a rounding tie; the nearest to one is {:.3f} BLU (v₁ = {}e5 BLU/s, dT = {} T), {:.3f} from it, "
      "printed {}.\n\n",
      entries - static_cast<std::size_t>(wrong), entries, tie.formula, tie.feed_in, tie.delay, tie.tie_distance(),
      tie.printed);
  text += conditions + errata_text() + "## Figures\n\nNumbers in the CSV file of the same name.\n\n";
  for (const char* name :
       {"fig01", "fig02", "fig03", "fig04", "fig05", "fig06", "fig07", "fig08", "fig09", "fig10", "fig11"})
    text += fmt::format("![{0}]({0}.svg)\n\n", name);
  text +=
      figure12_text() + "![fig12](fig12.svg)\n\nErrors over the delay are in `fig12-errors.csv`.\n\n" + claims_text();
  while (text.ends_with("\n\n")) text.pop_back();
  return text;
}

std::vector<std::pair<std::string, std::string>> files(const std::vector<Table>& tables, const std::string& command,
                                                       const std::string& version) {
  std::vector<std::pair<std::string, std::string>> out;
  for (const Table& table : tables) out.emplace_back(table.name + ".csv", tables_csv(table));
  for (const Drawing& drawing : drawings()) {
    for (std::size_t i = 0; i < drawing.data.size(); ++i) {
      out.emplace_back(drawing.name + (i == 0 ? ".csv" : "-errors.csv"), to_csv(drawing.data[i]));
    }
    out.emplace_back(drawing.name + ".svg", render_svg(drawing.figure));
  }
  out.emplace_back("report.md", report(tables));
  nlohmann::ordered_json manifest;
  manifest["schema"] = "accdec.manifest/1";
  manifest["command"] = command;
  manifest["versions"]["accdec"] = version;
  manifest["versions"]["compiler"] = __VERSION__;
  manifest["versions"]["eigen"] =
      fmt::format("{}.{}.{}", EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION);
  manifest["versions"]["gnuplot"] = first_line(run_process({"gnuplot", "--version"}, "", "gnuplot-nox").output);
  for (const auto& [name, content] : out) manifest["files"].push_back(name);
  out.emplace_back("manifest.json", manifest.dump(2) + "\n");
  return out;
}

}  // namespace accdec::paper
