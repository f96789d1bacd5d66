#pragma once

#include <span>

#include <accdec/exact/limit_model.hpp>

// Internal to the exact method: filters of any order in a linear program of few columns.
//
// Columns are the taps around an anchor sample; ends stand for all taps farther out. THEORY.md, "Filters of any order",
// says why that refutes all orders.

namespace accdec::exact {

/// Whether a row is known in a window: it concerns only the taps inside, or has weights for those beyond.
bool inside_window(const proof::Row& id, const Box& box, const ConvexRows& rows);
/// Adds y times the coefficients of the window's taps in a vibration row. Taps that an end stands for count with at
/// least -1.
void add_window_vibration(const LimitModel& model, const proof::Vibration& id, double y, std::span<double> taps);
/// As `refutation`, over filters of any order; minus infinity for rows that are not inside.
double window_refutation(const LimitModel& model, const Multipliers& y, const Box& box);

}  // namespace accdec::exact
