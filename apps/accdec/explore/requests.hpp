#pragma once

#include <atomic>
#include <string>
#include <string_view>

namespace accdec {
struct Task;
}

namespace accdec::explore {

/// One question of the page. Everything is text, so that a page with the library inside could ask in the same way.
struct Question {
  std::string_view name;    ///< "design", "view", "families", "explain", "check", "export" or "file"
  std::string_view body;    ///< the task as JSON; check: a list of tasks; view, and export of taps: a result
  std::string_view format;  ///< export: one of `taps_formats`, or "result"; design: "given"
  std::size_t corner = 0;   ///< design, view: the one whose motion is drawn
  double seconds = 1.0;     ///< for the whole answer; at most `most_seconds`
  /// design: as `accdec design`, to the last digit. The shares of a shorter time limit choose another way, which may
  /// end with another filter that is as fast. `cancel` ends it after `seconds`.
  bool whole = false;
  std::string_view place{};  ///< of the page and slot that ask: the last results of each are held; empty: none are
  std::size_t held = 0;      ///< view, export: the number of a result that is held, in place of a body; 0: none
  const std::atomic<bool>* cancel = nullptr;  ///< true: the answer is not wanted any more, or the time is over
};
inline constexpr double most_seconds = 60.0;
/// The page draws every corner; tasks with more are for `accdec design`.
inline constexpr std::size_t most_corners = 200;
inline constexpr int most_taps = 100'000;  ///< of a given filter: an answer of 2.5 MB in half a second

struct Answer {
  int status = 200;  ///< as HTTP has it; from 400 on the text is {"error": ".."}
  std::string type = "application/json";
  std::string text;
};

/// Answers a question; errors of any kind are answers, too.
///
/// The answer to "design" is an object. Its result is as `accdec design --json`, without the proof. It also says
/// whether that proof was rechecked, and with which number the result is held. It has the motion at the corner asked
/// for, and the setting in the words of the control. Its list of `views` has null for other corners, and for this one
/// if a long filter left no time. The answer to "view" is such a motion. The answer to "families" has the best member
/// of each family that controllers have. The answer to "explain" is that of `accdec explain --json`; its `words` have
/// the sentences and the table of changes as `accdec explain` prints them. The answer to "check" has, for each task it
/// had time for, why that cannot be designed, or null. The answer to "export" is a file, that to "file" the task as a
/// task file.
Answer answer(const Question& question);

/// The page begins with this: the task, every key of a task, the shipped tasks, the formats of exports.
/// @param name  of the task's file, for people; may be empty
std::string start_json(const Task& task, const std::string& name);

/// A task that the page cannot show. @throws std::invalid_argument saying what can
void require_small(std::size_t corners);

}  // namespace accdec::explore
