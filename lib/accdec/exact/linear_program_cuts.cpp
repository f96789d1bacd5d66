#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include <accdec/exact/linear_program.hpp>
#include <accdec/exact/one_width.hpp>
#include <accdec/exact/window.hpp>
#include <accdec/machine.hpp>

// Rows that a solution of the linear program breaks.

namespace accdec::exact {
namespace {

/// rad inside of which cuts grow with both distances in spite of rounding
constexpr double inside = 1e-12;

/// A row of a mode that a command breaks, seen at the phase at which it is left with most.
proof::Vibration at_worst_phase(proof::Vibration id, const LimitModel& model, const Filter& command) {
  const double natural = 2.0 * std::numbers::pi * id.frequency * model.task().sample_period;
  const double turn = natural * std::sqrt((1.0 - id.damping) * (1.0 + id.damping));
  double c = 0.0, s = 0.0;
  for (int i = 0; i <= command.order(); ++i) {
    const double left = command.tap(i) * std::exp(-id.damping * natural * (command.order() - i));
    c += left * std::cos(turn * i);
    s += left * std::sin(turn * i);
  }
  id.angle = std::atan2(s, c);
  return id;
}

/// Adds the residuals of a mode of an axis that are too large, after starts, stops and blends of single delays.
void add_residuals(const LimitModel& model, std::size_t m, const Filter& command, const Box& box, double slack,
                   std::vector<proof::Vibration>& broken) {
  const Mode& mode = model.task().machine.modes[m];
  double fastest = 0.0;
  const auto look = [&](int corner, double v1, double v2, int delay) {
    const LimitUse use = residual_utilisation(command, v1, v2, delay, model.task().sample_period, mode);
    if (use.utilisation > 1.0 + slack) broken.push_back({static_cast<int>(m), use.frequency, 0.0, use.damping, corner});
  };
  for (std::size_t j = 0; j < box.corners.size(); ++j) {
    const Legs v = legs(model.task().corners[j], static_cast<std::size_t>(mode.axis));
    fastest = std::max({fastest, std::abs(v.in), std::abs(v.out)});
    const bool counts = v.in != 0.0 && v.out != 0.0 && box.corners[j].d1 == box.corners[j].d2 && !box.window;
    if (counts) look(static_cast<int>(j), v.in, v.out, box.corners[j].d1);
  }
  look(-1, 0.0, fastest, 0);
}

/// Rows of modes that a filter breaks.
std::vector<proof::Vibration> broken_modes(const LimitModel& model, const Filter& filter, const Box& box,
                                           double slack) {
  const Machine& machine = model.task().machine;
  std::optional<Filter> made;
  const Filter& command = model.rows.smoothing().behind(filter, made);
  const auto uses = vibration_utilisation(command, model.task().sample_period, machine);
  std::vector<proof::Vibration> broken;
  std::size_t of_filter = 0;
  for (std::size_t m = 0; m < machine.modes.size(); ++m) {
    if (machine.modes[m].of_axis()) {
      add_residuals(model, m, command, box, slack, broken);
      continue;
    }
    const LimitUse& use = uses[of_filter++];
    if (use.value > use.bound * (1.0 + slack) + 1e-13)
      broken.push_back({static_cast<int>(m), use.frequency, 0.0, use.damping});
  }
  for (proof::Vibration& id : broken) id = at_worst_phase(id, model, command);
  return broken;
}

}  // namespace

bool LinearProgram::cut(const Filter& filter, const Box& box, double allowed) {
  bool added = cut_cones(filter, box, allowed);
  for (const proof::Row& id : model_.rows.broken_blend_rows(filter, box, broken(), true))
    added |= (!kind_.window || inside_window(id, box, model_.rows)) && add_limit(id, box);
  if (!kind_.window) {
    for (const Chord& chord : model_.chords.broken(filter, box, broken())) added |= add_limit(row_of(chord), box);
  }
  if (by_one_width(model_.task())) {
    std::optional<Filter> made;
    const auto width = broken_width(model_.task(), filter, model_.rows.smoothing().behind(filter, made), box);
    if (width && !names_.known(proof::Row(*width))) {
      add(*drafts_.width(*width, box), proof::Row(*width));
      added = true;
    }
  }
  return cut_vibration(filter, box) || added;
}

bool LinearProgram::add_limit(const proof::Row& id, const Box& box) {
  if (names_.known(id)) return false;
  // Rows of starts and stops serve every order.
  Box all;
  all.order = largest_, all.window = box.window;
  const bool of_event = std::holds_alternative<proof::EventForce>(id);
  add(drafts_.limit(model_.row(id, of_event ? all : box), 1.0, false), id);
  return true;
}

bool LinearProgram::cut_cones(const Filter& filter, const Box& box, double allowed) {
  bool added = false;
  for (std::size_t j = 0; j < box.corners.size(); ++j) {
    if (!model_.cone(j) || box.only_angle) continue;
    if (RowDrafts::shared(j, box)) {
      cut_ranges(j, filter, box, allowed, added);
      continue;
    }
    double p = 0.0, q = 0.0;
    for (int i = 0; i <= filter.order(); ++i) {
      p += filter.tap(i) * box.weight_in(j, i);
      q += filter.tap(i) * box.weight_out(j, i);
    }
    p *= model_.scale_in(j), q *= model_.scale_out(j);
    const double theta = model_.theta(j);
    double angle = std::atan2(q * std::sin(theta), p + q * std::cos(theta));
    // Within a box only cuts that grow with both distances hold.
    if (box.loose(j))
      angle = std::clamp(angle, theta - 0.5 * std::numbers::pi + inside, 0.5 * std::numbers::pi - inside);
    const double value = p * std::cos(angle) + q * std::cos(theta - angle);
    if (value <= model_.error_bound(j) * (1.0 + broken()) + 1e-13 + std::max(allowed, 0.0) * (1.0 + slack)) continue;
    const auto same = [&](const proof::Error& old) {
      return old.corner == static_cast<int>(j) && std::abs(old.angle - angle) < same_angle;
    };
    if (names_.known<proof::Error>(same)) continue;  // the linear program's own tolerance
    add_cone(j, angle, box);
    added = true;
  }
  return added;
}

bool LinearProgram::add_vibration(const proof::Vibration& id, const Box& box) {
  const auto same = [&](const proof::Vibration& old) {
    return old.mode == id.mode && old.corner == id.corner && old.frequency == id.frequency &&
           old.damping == id.damping && std::abs(old.angle - id.angle) < same_angle;
  };
  if (names_.known<proof::Vibration>(same)) return false;
  add(drafts_.vibration(id, box), id);
  return true;
}

bool LinearProgram::cut_vibration(const Filter& filter, const Box& box) {
  bool added = false;
  for (proof::Vibration id : broken_modes(model_, filter, box, broken())) {
    const double bound = model_.rows.vibration_bound(id, box);
    if (bound == infinity || (kind_.window && !inside_window(id, box, model_.rows)) || !add_vibration(id, box))
      continue;
    added = true;
    // A zero response needs both components held.
    if (bound >= 1e-6) continue;
    id.angle += 0.5 * std::numbers::pi;
    add_vibration(id, box);
  }
  return added;
}

}  // namespace accdec::exact
