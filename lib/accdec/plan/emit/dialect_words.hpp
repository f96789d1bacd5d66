#pragma once

#include <string>
#include <vector>

#include <accdec/program.hpp>

namespace accdec {

/// @throws std::invalid_argument for a named controller with settings whose file has no words for programs
void require_dialect(const ControllerSettings& control);

/// @throws std::invalid_argument for a control that delays by timed moves alone, which emit_for_linuxcnc writes
void require_dwells(const ControllerSettings& control);

/// The words of a named controller for a plan that is written as a program.
class DialectWords {
 public:
  /// @param result  if its settings are of a named controller, the words are those of that one's file
  /// @param wanted  false: none are used
  /// @throws std::invalid_argument if the file has none
  DialectWords(const ProgramResult& result, bool wanted);

  bool used() const { return control_ != nullptr; }
  /// "(text)" as the control writes remarks; other words as they are.
  std::string remark(const std::string& words) const;
  /// Words of the program as it was read: remarks, and dwells in seconds.
  std::string passed(const std::string& words) const;
  /// Lines that begin the program.
  std::vector<std::string> begin() const;
  /// Behind the words of a block whose end is passed so, with a blank before; empty: nothing.
  std::string at(DelayKind kind) const;
  /// The same for a full stop; without a word for it, that of in-position, and `behind_stop` waits for the rest.
  std::string at_stop() const;
  /// A line that waits until a filter has come to rest; empty where the stop's own word does so.
  std::string behind_stop(const Filter& filter) const;
  /// A line that delays by so many samples; empty where the block's word does so.
  std::string behind(DelayKind kind, int samples) const;

 private:
  std::string dwell(const std::string& seconds) const;

  const ControllerSettings* control_ = nullptr;
  double period_;
};

}  // namespace accdec
