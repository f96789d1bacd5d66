#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/files/shown_text.hpp>
#include <accdec/formats/design_report.hpp>
#include <accdec/formats/explanation.hpp>
#include <accdec/machine/limit_unit.hpp>
#include <accdec/machine/mode_text.hpp>
#include <accdec/task/not_considered.hpp>
#include <accdec/task/settings_text.hpp>

namespace accdec {
namespace {

std::string percent(double share) {
  return fmt::format("{:g} %", std::round(share * 1e4) * 1e-2);
}

std::string number(const Lever& lever, double si) {
  return fmt::format("{:.9g}{}{}", lever.per_si * si, lever.unit.empty() ? "" : " ", lever.unit);
}

/// One value if all levers have the same, else one value each.
template <class Value>
std::string numbers(const Room& room, Value value) {
  std::vector<std::string> texts;
  for (const Lever& lever : room.levers) texts.push_back(number(lever, value(lever)));
  if (std::all_of(texts.begin(), texts.end(), [&](const std::string& t) { return t == texts.front(); }))
    return texts.front();
  return texts.size() <= 3 ? fmt::format("{}", fmt::join(texts, ", ")) : "each its own";
}

/// "1 to 12, 14".
std::string ranges(const std::vector<int>& samples) {
  std::vector<std::string> parts;
  for (std::size_t i = 0; i < samples.size();) {
    std::size_t j = i;
    while (j + 1 < samples.size() && samples[j + 1] == samples[j] + 1) ++j;
    if (j - i < 2) {
      for (; i <= j; ++i) parts.push_back(std::to_string(samples[i]));
    } else {
      parts.push_back(fmt::format("{} to {}", samples[i], samples[j]));
    }
    i = j + 1;
  }
  return fmt::format("{}", fmt::join(parts, ", "));
}

/// With many corners, only the smallest and the largest delay.
std::string delays_text(const std::vector<int>& delays) {
  if (delays.size() > 40) {
    const auto [least, most] = std::minmax_element(delays.begin(), delays.end());
    return fmt::format("{} to {}", *least, *most);
  }
  return fmt::format("{}", fmt::join(delays, " "));
}

/// Whether the room has limits of more than one kind.
bool all_limits(const Room& room) {
  return std::any_of(room.levers.begin(), room.levers.end(),
                     [&](const Lever& lever) { return lever.kind != room.levers.front().kind; });
}

std::string binding_text(const Explanation& e, bool samples) {
  if (e.bindings.empty()) return "No limit is used to the full.\n";
  std::string text = fmt::format("Used to the full ({} or more{}):\n", percent(full_use),
                                 samples ? "" : "; --verbose: at which samples");
  const Binding* before = nullptr;
  for (const Binding& b : e.bindings) {
    const LimitUnit unit = limit_unit(b.kind, b.axis);
    std::string what(b.kind == LimitKind::speed_min ? "smallest speed" : limit_word(b.kind, b.axis));
    std::replace(what.begin(), what.end(), '_', ' ');
    const bool same =
        before != nullptr && before->kind == b.kind && before->axis == b.axis && before->corner == b.corner;
    const std::string where = b.kind == LimitKind::vibration ? place_of_vibration(b)
                              : b.kind == LimitKind::residual
                                  ? fmt::format("{} {}", to_string(b.event), place_of_vibration(b))
                              : samples ? fmt::format("k = {} of the {}", ranges(b.samples), to_string(b.event))
                                        : std::string(to_string(b.event));
    if (same) {
      text.back() = samples ? ';' : ',';
      text += fmt::format(" {}\n", where);
    } else {
      text += fmt::format("  {}{}{}{} ({:.9g} {}): {}\n", b.corner.empty() ? "" : fmt::format("corner {}, ", b.corner),
                          what, b.axis.empty() ? "" : " ", b.axis, unit.per_si * b.bound, unit.name, where);
    }
    before = &b;
  }
  return text;
}

std::string gain_table(const Explanation& e) {
  TextTable table({"more room for", "now", "then", "saves ms", "saves %", "N", "d", ""});
  for (const std::size_t column : {1, 2, 7}) table.left(column);
  const double base = e.base.objective();
  for (const Gain& g : e.gains) {
    const std::string proof = g.proved()              ? (g.solved ? "proved" : "proved with others")
                              : g.at_most < unlimited ? fmt::format("at most {} ms", shown_ms(g.at_most))
                                                      : "not proved";
    table.add({g.room.name, numbers(g.room, [](const Lever& l) { return l.value; }),
               numbers(g.room, [&](const Lever& l) { return l.moved(e.share); }), shown_ms(g.gain),
               fmt::format("{:.1f}", 100.0 * g.gain / base), std::to_string(g.order), delays_text(g.delays), proof});
  }
  return table.str();
}

std::string gain_text(const Explanation& e) {
  std::string text;
  if (!e.gains.empty()) {
    text += fmt::format("\nWith {} more room, the task designed again:\n{}\n{}\n", percent(e.share), gain_table(e),
                        legend({"N", "d"}));
    // All together is no answer to the question which one. If one [[axis]] stands for all, "of all axes" is one key.
    const auto best = std::find_if(e.gains.begin(), e.gains.end(), [](const Gain& g) { return !all_limits(g.room); });
    if (best != e.gains.end() && best->gain > 0.0) {
      text += fmt::format("No single limit saves more than {}: {} instead of {} saves {} ms ({:.1f} %).\n",
                          best->room.name, numbers(best->room, [&](const Lever& l) { return l.moved(e.share); }),
                          numbers(best->room, [](const Lever& l) { return l.value; }), shown_ms(best->gain),
                          100.0 * best->gain / e.base.objective());
    } else if (e.gains.front().gain > 0.0) {
      text += "No one limit saves anything, only several together.\n";
    } else {
      text += "None saves anything.\n";
    }
    text += fmt::format(
        "Orders and delays are whole samples of {:g} ms, so a saving of less than a sample is shown as 0.\n",
        1e3 * e.base.task.sample_period);
  }
  for (const Lever& lever : e.not_moved)
    text += fmt::format("{} is 0, so it cannot be relaxed by a share.\n", lever.name);
  return text;
}

void add_remedies(const Explanation& e, ExplanationWords& words) {
  words.changes.head = {"change of", "now", "enough", "change", "then ms", ""};
  std::vector<std::string> useless, unknown;
  for (const Remedy& r : e.remedies) {
    if (r.help == Remedy::Help::no) useless.push_back(r.room.name);
    if (r.help == Remedy::Help::unknown) unknown.push_back(r.room.name);
    if (r.help != Remedy::Help::yes) continue;
    std::size_t i = 0;
    const std::string enough = numbers(r.room, [&](const Lever&) { return r.values[i++]; });
    const Lever& first = r.room.levers.front();
    const double change = first.value > 0.0 ? r.values.front() / first.value - 1.0 : 0.0;
    words.changes.rows.push_back({r.room.name, numbers(r.room, [](const Lever& l) { return l.value; }), enough,
                                  first.value > 0.0 ? fmt::format("{:+.3g} %", 100.0 * change) : "from 0",
                                  shown_ms(r.objective),
                                  r.smallest ? "less is not enough: proved" : "less may be enough"});
  }
  if (!words.changes.rows.empty()) {
    words.above = fmt::format(
        "Smallest change, tried one by one, that makes a design possible (verified by simulation; to within {} of the "
        "given value, rounded to four digits):",
        percent(remedy_tolerance));
  }
  if (!useless.empty())
    words.notes.push_back(fmt::format("No change of these helps by itself: {}.", fmt::join(useless, ", ")));
  if (!unknown.empty())
    words.notes.push_back(
        fmt::format("Not settled in the time of a single design: {}. A longer --design-time-limit may settle it.",
                    fmt::join(unknown, ", ")));
}

std::string changes_table(const ReportTable& changes) {
  TextTable table(changes.head);
  for (const std::size_t column : {1, 2, 5}) table.left(column);
  for (const auto& row : changes.rows) table.add(row);
  return table.str();
}

}  // namespace

ExplanationWords explanation_words(const Explanation& e) {
  ExplanationWords words;
  if (!e.base.filter) {
    words.verdict = fmt::format("No design{}: {}", e.base_proved ? ", proved" : "", e.base.message);
    add_remedies(e, words);
  }
  if (e.base.task.corners.size() > corners_apart_max)
    words.notes.push_back(fmt::format("Each of more than {} corners by itself was not asked about, only all together.",
                                      corners_apart_max));
  if (e.shared > 0.0)
    words.notes.push_back(
        fmt::format("Nothing can be proved here, so all designs together had {:.3g} s: more may be saved. A longer "
                    "--design-time-limit and --time-limit search longer.",
                    e.shared));
  if (!e.complete) words.notes.emplace_back("Stopped early: changes that are not listed were not tried.");
  words.notes.push_back(fmt::format("Ignored: {}.", not_considered_text(e.base.task.machine)));
  return words;
}

std::string explanation_text(const Explanation& e, bool samples) {
  std::string text = e.base.task.title.empty() ? "" : e.base.task.title + "\n";
  if (e.base.filter) {
    std::vector<int> delays;
    for (const CornerResult& corner : e.base.corners) delays.push_back(corner.delay);
    const bool whole = e.base.task.design.objective == Objective::cycle;
    text += fmt::format(
        "{} of {} ms, order {}, delay{} {}: {}.{}\n", whole ? "Cycle time" : "Corner times",
        shown_ms(e.base.objective()), e.base.filter->order(), delays.size() == 1 ? "" : "s", delays_text(delays),
        e.base_proved ? e.base.settings ? proved_best_in_words(*e.base.task.settings) : "proved to be the shortest"
        : e.base.lower_bound ? fmt::format("not below {} ms is proved", shown_ms(*e.base.lower_bound))
                             : "nothing is proved",
        assumed_in_words(e.base.settings ? &*e.base.task.settings : nullptr));
    text += gain_text(e) + "\n" + binding_text(e, samples);
  }
  const ExplanationWords words = explanation_words(e);
  if (!words.verdict.empty()) text += words.verdict + "\n";
  if (!words.above.empty()) text += fmt::format("\n{}\n{}", words.above, changes_table(words.changes));
  for (const std::string& note : words.notes) text += fmt::format("\n{}\n", note);
  return text;
}

}  // namespace accdec
