#include <algorithm>
#include <cmath>

#include <accdec/exact/dual_simplex.hpp>
#include <accdec/exact/one_width.hpp>
#include <accdec/exact/range_cut.hpp>
#include <accdec/exact/reversal.hpp>
#include <accdec/exact/row_drafts.hpp>
#include <accdec/exact/window.hpp>

namespace accdec::exact {

const DraftRow& RowDrafts::sum_of_taps() {
  draft_.clear();
  for (int i = 0; i <= largest_; ++i) draft_.add(i, 1.0);
  draft_.low = draft_.high = 1.0;
  return draft_;
}

const DraftRow& RowDrafts::equal_taps(int one, int other) {
  draft_.clear();
  draft_.add(one, 1.0), draft_.add(other, -1.0);
  draft_.low = draft_.high = 0.0;
  return draft_;
}

const DraftRow& RowDrafts::response(int sample) {
  draft_.clear();
  const Smoothing& motion = model_.rows.motion();
  for (int i = 0; i < sample && i <= largest_; ++i) {
    if (const double c = motion.sum(sample - i); c != 0.0) draft_.add(i, c);
  }
  draft_.low = 0.0, draft_.high = 1.0 + slack;
  return draft_;
}

void RowDrafts::clear_command() {
  on_command_.assign(static_cast<std::size_t>(largest_ + model_.rows.smoothing().order()) + 1, 0.0);
}

void RowDrafts::add_command() {
  const Smoothing& smoothing = model_.rows.smoothing();
  if (smoothing.none()) return add_columns(on_command_);
  on_tap_.assign(static_cast<std::size_t>(largest_) + 1, 0.0);
  smoothing.add_designed(on_command_, on_tap_);
  add_columns(on_tap_);
}

void RowDrafts::add_columns(const std::vector<double>& taps) {
  for (int i = 0; i <= largest_; ++i) {
    if (const double c = taps[static_cast<std::size_t>(i)]; c != 0.0) draft_.add(i, c);
  }
}

const DraftRow& RowDrafts::limit(const SparseRow& row, double scale, bool both, bool soft) {
  draft_.clear();
  if (soft) draft_.add(excess(), -1.0);
  if (row.of_motion) {
    on_tap_.assign(static_cast<std::size_t>(largest_) + 1, 0.0);
    model_.rows.add_motion(row, scale, window_, on_tap_);
    add_columns(on_tap_);
  } else {
    clear_command();
    for (const auto& [i, c] : row.taps) on_command_[static_cast<std::size_t>(i)] += c * scale;
    for (const auto& [k, c] : row.sums) {
      for (int i = 0; i < k; ++i) on_command_[static_cast<std::size_t>(i)] += c * scale;
    }
    add_command();
  }
  const double bound = (1.0 + slack_) * scale;
  draft_.low = both ? -bound : -DualSimplex::infinity;
  draft_.high = bound - row.constant * scale;
  return draft_;
}

const DraftRow& RowDrafts::cone(const proof::Error& id, const Box& box) {
  const auto j = static_cast<std::size_t>(id.corner);
  const double wp = model_.weight_in(j, id.angle), wq = model_.weight_out(j, id.angle);
  draft_.clear();
  draft_.add(excess(), -1.0);
  for (int i = 0; i <= box.order; ++i) {
    const double c = wp * box.weight_in(j, i) + wq * box.weight_out(j, i);
    if (c != 0.0) draft_.add(i, c);
  }
  draft_.low = -DualSimplex::infinity;
  draft_.high = model_.error_bound(j) * (1.0 + slack_);
  return draft_;
}

const DraftRow* RowDrafts::contour(const proof::Contour& id, const Box& box) {
  const auto j = static_cast<std::size_t>(id.corner);
  if (!box.contour_rows()) return nullptr;
  draft_.clear();
  draft_.add(excess(), -1.0);
  for (int i = 0; i <= box.order; ++i) {
    const double c = id.out ? model_.scale_out(j) * box.contour_out(j, i) : model_.scale_in(j) * box.contour_in(j, i);
    if (c != 0.0) draft_.add(i, c);
  }
  draft_.low = -DualSimplex::infinity;
  draft_.high = model_.contour_bound(j) * (1.0 + slack_);
  return draft_.columns.size() > 1 ? &draft_ : nullptr;
}

const DraftRow& RowDrafts::range_cone(const proof::RangeError& id, const Box& box) {
  const auto j = static_cast<std::size_t>(id.corner);
  const RangeRow row = range_row(box, j, id.in, id.out, model_.weight_in(j, id.angle), model_.weight_out(j, id.angle));
  draft_.clear();
  draft_.add(excess(), -1.0);
  if (row.on_delay != 0.0) draft_.add(delay_column(j), row.on_delay);
  if (row.on_sample != 0.0) draft_.add(sample_column(j), row.on_sample);
  for (int i = 0; i <= box.order; ++i) {
    if (const double c = row.taps[static_cast<std::size_t>(i)]; c != 0.0) draft_.add(i, c);
  }
  draft_.low = -DualSimplex::infinity;
  draft_.high = model_.error_bound(j) * (1.0 + slack_) - row.constant;
  return draft_;
}

double RowDrafts::vibration_scale(const proof::Vibration& id) const {
  const double bound = model_.rows.vibration_bound(id);
  return bound > 0.01 ? 1.0 / bound : 1.0;
}

const DraftRow& RowDrafts::vibration(const proof::Vibration& id, const Box& box) {
  const double scale = vibration_scale(id);
  draft_.clear();
  clear_command();
  const auto in_box = static_cast<std::size_t>(box.order + model_.rows.smoothing().order()) + 1;
  if (window_)
    add_window_vibration(model_, id, scale, on_command_);
  else  // damping counts from the box's last tap; without, a row serves every order
    model_.rows.add_vibration(id, scale, id.damping > 0.0 ? std::span(on_command_).first(in_box) : on_command_);
  add_command();
  draft_.high = scale * model_.rows.vibration_bound(id, box) * (1.0 + slack_);
  draft_.low = window_ ? -DualSimplex::infinity : -draft_.high;
  return draft_;
}

const DraftRow& RowDrafts::budget(const Box& box) {
  draft_.clear();
  for (std::size_t j = 0; j < box.corners.size(); ++j) {
    draft_.add(delay_column(j), model_.task().corners[j].weight);
  }
  draft_.low = -DualSimplex::infinity;
  draft_.high = *box.budget;
  return draft_;
}

const DraftRow* RowDrafts::width(const proof::Width& id, const Box& box) {
  const auto row = width_row(model_.task(), id, box);
  if (!row) return nullptr;
  draft_.clear();
  clear_command();
  if (row->actual) {
    for (int i = 0; i <= box.order; ++i) draft_.add(i, row->weight(box, i));
  } else {
    const int last = box.order + model_.rows.smoothing().order();
    for (int i = 0; i <= last; ++i) on_command_[static_cast<std::size_t>(i)] = row->weight(box, i);
    add_command();
  }
  draft_.low = -DualSimplex::infinity;
  draft_.high = -width_margin;
  return &draft_;
}

const DraftRow* RowDrafts::again(const proof::Error& id, const Box& box) {
  const auto j = static_cast<std::size_t>(id.corner);
  if (shared(j, box)) return nullptr;
  const bool grows = std::cos(id.angle) >= 0.0 && std::cos(model_.theta(j) - id.angle) >= 0.0;
  if (!grows && box.loose(j)) return nullptr;
  if (box.only_angle && *box.only_angle != id.angle) return nullptr;
  return &cone(id, box);
}

const DraftRow* RowDrafts::again(const proof::RangeError& id, const Box& box) {
  if (!shared(static_cast<std::size_t>(id.corner), box)) return nullptr;
  return &range_cone(id, box);
}

template <class BlendRow>
const DraftRow* RowDrafts::again_at_blend(const BlendRow& id, const Box& box) {
  if (!known_in(id, box) || (window_ && !inside_window(id, box, model_.rows))) return nullptr;
  const SparseRow row = model_.rows.row(id, box);
  return row.no_terms() ? nullptr : &limit(row, 1.0, false);
}

const DraftRow* RowDrafts::again(const proof::Blend& id, const Box& box) {
  return again_at_blend(id, box);
}

const DraftRow* RowDrafts::again(const proof::Reversal& id, const Box& box) {
  return again_at_blend(id, box);
}

const DraftRow* RowDrafts::again(const proof::Vibration& id, const Box& box) {
  return model_.rows.vibration_bound(id, box) < infinity ? &vibration(id, box) : nullptr;
}

const DraftRow* RowDrafts::again(Chord& chord, const Box& box) {
  const Chords& chords = model_.chords;
  if (chord.sample > chords.last_sample(chord.family, box) || !chords.single_delay(chord.family, box)) return nullptr;
  const auto drawn = chords.draw(chord.family, chord.sample, box);
  if (!drawn) return nullptr;
  chord = *drawn;
  return &limit(chords.row(chord, box), 1.0, false);
}

}  // namespace accdec::exact
