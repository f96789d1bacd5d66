#pragma once

#include <algorithm>
#include <string>

#include <accdec/certificate.hpp>
#include <accdec/files/text_file.hpp>

namespace accdec {

class Value;

/// `accdec.certificate/1`, the member `certificate` of a result, as text without blanks. A tree is a list of nodes in
/// preorder. A node is null (too long), "unreachable", or an index into `multipliers` (refuted). It may also be a pair
/// of indices (symmetric filters of two orders), ["symmetric"] or ["N", order]. Splits are [corner, "d" or "k", at] and
/// [sample, "B", level]. A set of multipliers is a list of rows: the row's name, the things it names, its multiplier.
std::string certificate_to_json(const Certificate& certificate);
/// The same in the form used in a result. A long one is packed as {"kind": "packed", "gzip": text, "schema": ..}
/// (files/packed_text.hpp).
std::string stored_certificate(const Certificate& certificate);

/// Reads a certificate strictly: names, lengths, types and whole numbers of 31 bits. The checker decides whether the
/// things it names exist and prove anything (certificate.hpp). A packed one may unpack to 64 times its length.
/// @throws Mistake at the place of the offending value
Certificate read_certificate(const Value& value);

/// bytes that a packed certificate of this length may unpack to: more than any written certificate needs, and so few
/// that no short file fills the memory
constexpr std::size_t most_unpacked(std::size_t packed) {
  return std::min(result_file_limit, 64 * packed);
}

}  // namespace accdec
