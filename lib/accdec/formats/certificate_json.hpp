#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include <accdec/certificate/certificate.hpp>

namespace accdec {

class Value;

/// `accdec.certificate/1`, the member `certificate` of a result. A tree is a list of nodes in preorder: null (too
/// long), "unreachable", an index into `multipliers` (refuted), a pair of them (symmetric filters of two orders),
/// ["symmetric"], ["N", order], [corner, "d" or "k", at] and [sample, "B", level]. A set of multipliers is a list of
/// rows: the row's name, what it names, its multiplier.
nlohmann::ordered_json json_of(const Certificate& certificate);
/// The same as text without blanks.
std::string certificate_to_json(const Certificate& certificate);

/// Reads that back, strictly in its form: names, lengths, types and whole numbers of 31 bits. Whether what it names is
/// there and proves anything is for the checker to say (certificate/checker.hpp).
/// @throws Mistake at the place of the offending value
Certificate read_certificate(const Value& value);

}  // namespace accdec
