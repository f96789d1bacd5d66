#pragma once

#include <optional>

#include <accdec/exact/limit_model.hpp>

// Dry friction turns round with its axis. An axis that reverses at a corner slows down and speeds up by forces of one
// sign, as its speed is monotone. So friction helps until it moves as along leg 2, and is against it from that sample
// on. With the sample known the limits are linear. A box has a range of it, and friction counts as a help before the
// range's end.

namespace accdec::exact {

/// Whether the row holds in the whole box: of one delay, and behind or before its range of the reversal.
bool known_in(const proof::Reversal& id, const Box& box);
/// Rows of the blend hold for one delay.
inline bool known_in(const proof::Blend& id, const Box& box) {
  return box.corner(id.corner).d1 == box.corner(id.corner).d2;
}
/// The box with every reversal at the sample at which this filter has it.
Box at_reversals(const LimitModel& model, const Filter& filter, Box box);
/// Corners of single delays: a split of a reversal such that this filter, which holds all rows of the box, holds the
/// rows of neither part. None: it holds the limits with its own reversals, or rounding decides.
std::optional<proof::ReversalSplit> missed_reversal(const LimitModel& model, const Filter& filter, const Box& box);

}  // namespace accdec::exact
