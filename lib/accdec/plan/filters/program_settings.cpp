#include <algorithm>
#include <cmath>
#include <cstdint>

#include <fmt/format.h>

#include <accdec/plan/feeds/control_delay.hpp>
#include <accdec/plan/filters/effort.hpp>
#include <accdec/plan/filters/program_settings.hpp>
#include <accdec/plan/filters/settings_members.hpp>
#include <accdec/task/filter_in_words.hpp>
#include <accdec/task/settings_notes.hpp>
#include <accdec/task/settings_text.hpp>

namespace accdec {
namespace {

/// See ProgramResult::taps_control.
constexpr const char* any_taps = "taps";

/// The settings looked at, and the limit that ended the search.
std::string what_was_tried(const ProgramSettings& settings) {
  if (settings.complete) return fmt::format("no other of {} settings is planned faster.", settings.members);
  const std::string ended = settings.search_limit
                                ? fmt::format(
                                      "The search ended by its own limit of work, {:.3g} s of one core; --time-limit "
                                      "{:.0f} searches twice as long.",
                                      *settings.search_limit, std::ceil(2.0 * *settings.search_limit / work_of_limit))
                                : "The time limit ended the search; a longer one plans more.";
  return fmt::format("{}: {} of {}{} settings planned, {} guessed. {}",
                     settings.tried > 1 ? "the fastest of those tried" : "the only one tried", settings.tried,
                     settings.members, settings.members >= SettableMembers::most ? " or more" : "", settings.guessed,
                     ended);
}

std::string beside_free_taps(const ProgramSettings& settings, double time) {
  const double free = *settings.free_taps, less = time - free;
  const std::string taps = free_taps_in_words(settings.control.get());
  const std::string until =
      settings.free_taps_limit ? fmt::format(" in a search of at most {:.3g} s", *settings.free_taps_limit) : "";
  if (!(less > 1e-9 * time)) return fmt::format(" {}: no faster plan was found{}.", taps, until);
  return fmt::format(" {} would take {:.6g} s ({} less) or less{}.", taps, free, percent_in_words(less / time),
                     until.empty() ? "" : ", as found" + until);
}

std::string beside_today(const ProgramResult& result) {
  if (result.settings && result.settings->is_today) return "";
  const std::string not_had = result.settings ? result.settings->today_not_had : "";
  if (!result.today) return not_had;
  const double today = *result.today, saved = today - result.cycle_time;
  if (!result.today_breaks.empty())
    return fmt::format(" Today's setting breaks {} at the programmed feeds.", result.today_breaks) + not_had;
  if (!(today < unlimited)) return " No plan with today's setting holds all limits." + not_had;
  std::string text = fmt::format(" Today's setting takes {:.6g} s as planned here; ", today);
  if (saved > 1e-9 * today)
    text += fmt::format("retuning saves {:.4g} s ({}).", saved, percent_in_words(saved / today));
  else
    text += saved < -1e-9 * today && not_had.empty() ? "it is the faster one, keep it." : "retuning saves nothing.";
  return text + not_had;
}

/// "; exact-stop at 3 joints, 1 of them inside arcs": those that have a delay of a kind. One of no samples is none.
std::string joints_with(const ProgramResult& result, DelayKindName kind) {
  const std::vector<DelayKind>& kinds = result.settings->chosen.delays;
  const FilteredCommand* command = result.plan.command();
  const std::vector<std::uint8_t>& inside_arc = result.plan.path.inside_arc;
  const bool any = kind.kind == DelayKind::dwell || kind.kind == DelayKind::timed_axis;
  std::size_t count = 0, inside = 0;
  for (std::size_t b = 0; b + 1 < kinds.size(); ++b) {
    const bool none = any && command != nullptr && b < command->delays.size() && command->delays[b] == 0;
    if (kinds[b] != kind.kind || none) continue;
    ++count;
    if (b < inside_arc.size() && inside_arc[b] != 0) ++inside;
  }
  if (count == 0) return "";
  std::string text = fmt::format("; {} at {} joint{}", kind.name, count, count == 1 ? "" : "s");
  if (inside > 0) text += fmt::format(", {} of them inside arcs", inside);
  return text;
}

/// Taps to set, in the words of the filter that they are; empty: of none.
std::string taps_in_words(int count, const std::string& filter) {
  const std::string taps = fmt::format("the {} taps that `accdec export` writes", count);
  return filter.empty() ? taps : fmt::format("{} ({})", filter, taps);
}

}  // namespace

std::string program_settings_in_words(const ProgramResult& result) {
  const ChosenSettings& chosen = result.settings->chosen;
  const std::string text =
      chosen.family == SettingFamily::taps
          ? taps_in_words(chosen.filter.full_order() + 1, filter_in_words(chosen.filter, result.sample_period))
          : settings_in_words(chosen);
  return text + (chosen.width ? "; " + width_in_words(*chosen.width) : "");
}

std::string program_settings_answer(const ProgramResult& result) {
  const ProgramSettings& settings = *result.settings;
  const double time = result.cycle_time;
  // One plan of today's setting is no advice to keep it.
  const bool no_search = settings.is_today && settings.tried == 1 && !settings.complete;
  std::string text = fmt::format("{}: {}",
                                 no_search           ? "The time was too short for an answer. Today's setting"
                                 : settings.is_today ? "Keep today's setting"
                                                     : "Set these",
                                 program_settings_in_words(result));
  for (const DelayKindName& kind : delay_kinds) {
    if (kind.kind != DelayKind::continuous) text += joints_with(result, kind);
  }
  text += fmt::format(". {:.6g} s for this program, ", time);
  if (settings.chosen.family == SettingFamily::taps)
    text += "not proved best.";
  else
    text += what_was_tried(settings);
  if (!settings.breaks.empty())
    text += fmt::format(" At the programmed feeds it breaks {}: blocks are slowed.", settings.breaks);
  text += stops_considered(settings.control.get());
  if (settings.control != nullptr && waits_at_ends(control_of(*settings.control, 0.0, result.sample_period)))
    text += " The control waits at the end of every block, with a turn or without: no block has two feeds.";
  if (settings.free_taps) text += beside_free_taps(settings, time);
  return text + beside_today(result) + assumed_in_words(settings.control.get()) + "\n";
}

std::string control_of_taps(const Task& task) {
  if (!task.settings || task.settings->names_family()) return "";
  const std::string own = task.filter ? filter_in_words(*task.filter, task.sample_period) : "";
  return task.settings->controller.empty() ? "" : own.empty() ? any_taps : own;
}

std::string program_taps_answer(const ProgramResult& result) {
  return fmt::format(
      "Set these: {}; {} delay{} as `--emit` writes them. {:.6g} s for this program, not proved best.{}\n",
      taps_in_words(result.plan.set().order() + 1, result.taps_control == any_taps ? "" : result.taps_control),
      result.delayed, result.delayed == 1 ? "" : "s", result.cycle_time, beside_today(result));
}

std::string program_answer(const ProgramResult& result) {
  if (!result.verification.feasible) return "";
  if (result.settings) return program_settings_answer(result);
  return result.taps_control.empty() || result.plan.command() == nullptr ? "" : program_taps_answer(result);
}

}  // namespace accdec
