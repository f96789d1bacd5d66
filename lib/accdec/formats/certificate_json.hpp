#pragma once

#include <algorithm>
#include <string>

#include <accdec/certificate/certificate.hpp>
#include <accdec/files/text_file.hpp>

namespace accdec {

class Value;

/// `accdec.certificate/1`, the member `certificate` of a result, as text without blanks. A tree is a list of nodes in
/// preorder: null (too long), "unreachable", an index into `multipliers` (refuted), a pair of them (symmetric filters
/// of two orders), ["symmetric"], ["N", order], [corner, "d" or "k", at] and [sample, "B", level]. A set of multipliers
/// is a list of rows: the row's name, what it names, its multiplier.
std::string certificate_to_json(const Certificate& certificate);
/// The same as it stands in a result: packed if it is long, as {"kind": "packed", "gzip": text, "schema": ..}
/// (files/packed_text.hpp).
std::string stored_certificate(const Certificate& certificate);

/// Reads that back, strictly in its form: names, lengths, types and whole numbers of 31 bits. Whether what it names is
/// there and proves anything is for the checker to say (certificate/checker.hpp). One that is packed may unpack to 64
/// times its length.
/// @throws Mistake at the place of the offending value
Certificate read_certificate(const Value& value);

/// bytes that a packed certificate of this length may unpack to: more than any that is written does, and little enough
/// that no short file takes all memory
constexpr std::size_t most_unpacked(std::size_t packed) {
  return std::min(result_file_limit, 64 * packed);
}

}  // namespace accdec
