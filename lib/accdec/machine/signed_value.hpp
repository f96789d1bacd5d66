#pragma once

#include <accdec/machine/limits.hpp>

namespace accdec {

/// The quantity that a limit bounds with its sign, as figures draw it: limits are on magnitudes. Power drawn for
/// regeneration lies below zero. SI.
inline double signed_value(const AxisState& state, LimitKind kind) {
  switch (kind) {
    case LimitKind::velocity: return state.velocity;
    case LimitKind::acceleration: return state.acceleration;
    case LimitKind::jerk: return state.jerk;
    case LimitKind::force: return state.force;
    case LimitKind::regeneration: return -state.braking;
    default: return axis_limit(kind).value(state);
  }
}

}  // namespace accdec
