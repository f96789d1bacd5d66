#pragma once

#include <functional>
#include <string>
#include <vector>

#include <accdec/certificate.hpp>
#include <accdec/result.hpp>
#include <accdec/task.hpp>

// Internal to the room: the check of proof::FamilyEnumeration.

namespace accdec {

/// Looks at every member of the families that a task's settings name, and refutes all that could cost less than a
/// target. A member is refuted where a start, a stop or a vibration breaks a limit, or where the delays it needs cost
/// too much. Its legs are summed sample by sample, and limits are wider than written as in every proof. Members
/// that this leaves open are simulated as the verification does.
/// @param target  samples of the objective; infinite: all members must break limits
/// @param stop    polled
/// @return the members refuted, by family and rule
/// @throws Rejected if a member is not refuted, or the check was stopped
std::vector<proof::RefutedMembers> refute_members(const Task& task, double target, const std::function<bool()>& stop);

/// Checks the proof against a result's claim, without the bound of free taps.
/// @return what was shown, in words
/// @throws Rejected if it was not
std::string check_families(const proof::FamilyEnumeration& proof, const Task& task, const DesignResult& result,
                           const std::function<bool()>& stop);

}  // namespace accdec
