#pragma once

#include <span>

#include <accdec/exact/limit_model.hpp>

// Internal to the exact method: filters of any order in a linear program of few columns.
//
// A filter may be shifted: its taps count from a sample at which some corner is closest, the anchor, and the columns
// 0 .. order are those around it. The first and the last column stand for all taps at or beyond them. Moved there, a
// tap far out changes no distance p or q for the worse, and no cumulative response inside, so whatever limits only the
// taps between them, or responses, and the errors as cuts that grow with both distances, hold as they stand. A box that
// is refuted like this holds no filter of any order.

namespace accdec::exact {

/// Whether a row says something of the taps inside a window alone.
bool inside_window(const proof::Row& id, const Box& box);
/// Adds y times the coefficients of the window's taps in a vibration row: of those that an end stands for at least -1.
void add_window_vibration(const LimitModel& model, const proof::Vibration& id, double y, std::span<double> taps);
/// As `refutation`, over filters of any order; minus infinity for rows that are not inside.
double window_refutation(const LimitModel& model, const Multipliers& y, const Box& box);

}  // namespace accdec::exact
