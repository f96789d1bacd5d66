#pragma once

#include <span>

#include <accdec/exact/limit_model.hpp>

// Internal to the exact method: filters of any order in a linear program of few columns.
//
// A filter may be shifted. Its taps are counted from a sample at which some corner, the anchor, is closest. The columns
// 0 .. order are the taps around it. If a tap far out is moved to such a column, no distance p or q gets worse and no
// cumulative response inside changes. So these limits hold unchanged: limits on the taps between the ends, limits on
// responses, and errors as cuts that grow with both distances. Forces behind a servo see taps far before. There an end
// has the least weight of all taps that it stands for. A box refuted this way holds no filter of any order.

namespace accdec::exact {

/// Whether a row is known in a window: it concerns only the taps inside, or has weights for those beyond.
bool inside_window(const proof::Row& id, const Box& box, const ConvexRows& rows);
/// Adds y times the coefficients of the window's taps in a vibration row. Taps that an end stands for count with at
/// least -1.
void add_window_vibration(const LimitModel& model, const proof::Vibration& id, double y, std::span<double> taps);
/// As `refutation`, over filters of any order; minus infinity for rows that are not inside.
double window_refutation(const LimitModel& model, const Multipliers& y, const Box& box);

}  // namespace accdec::exact
