#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include <accdec/files/errors.hpp>
#include <accdec/task/result.hpp>

namespace accdec {

/// A result as `accdec.result/1`: SI units in the keys, doubles with as many digits as reading them back to the last
/// bit takes, `task` as understood so that the result stands alone. What is not finite or not there (an infinite
/// utilisation, no proved bound, no filter) is null. Ends with a line feed.
std::string result_to_json(const DesignResult& result);
/// Bytes that the certificate takes of it; 0 without one.
std::size_t proof_size(const DesignResult& result);

/// Reads that back, strictly: unknown, missing and mistyped members, another schema, numbers that are not finite,
/// corners that do not match the task are errors. Nothing is recomputed: `accdec verify` does that.
/// @throws InputError at the position of the offending value, with its path in the message.
DesignResult parse_result(std::string_view text, const std::string& name);
DesignResult read_result(const std::string& path);

}  // namespace accdec
