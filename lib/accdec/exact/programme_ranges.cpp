#include <algorithm>
#include <cmath>
#include <numbers>

#include <accdec/exact/programme.hpp>
#include <accdec/exact/range_cut.hpp>

// The part of the linear programme that several corners share: their delays and samples as columns, and what the target
// leaves of the delays together.

namespace accdec::exact {

void Programme::prepare_ranges(const Box& box, const std::vector<RowId>& old) {
  for (std::size_t j = 0; j < box.corners.size(); ++j) {
    const CornerBox& c = box.corners[j];
    const bool ranges = shared(j, box) && model_.cone(j);
    lp_.setColumnBounds(delay_column(j), 0.0, box.budget ? c.d2 - c.d1 : 0.0);
    lp_.setColumnBounds(delay_column(j) + 1, 0.0, ranges ? c.k2 - c.k1 : 0.0);
  }
  if (!box.budget) return;
  std::vector<int> columns;
  std::vector<double> weights;
  for (std::size_t j = 0; j < box.corners.size(); ++j) {
    columns.push_back(delay_column(j)), weights.push_back(model_.task().corners[j].weight);
  }
  RowId budget;
  budget.kind = RowKind::budget;
  add(columns, weights, -COIN_DBL_MAX, *box.budget, budget);
  std::vector<bool> kept(box.corners.size(), false);
  for (const RowId& id : old) {
    const auto j = static_cast<std::size_t>(id.corner);
    if (!shared(j, box)) continue;
    add_range_cone(id, box);
    kept[j] = true;
  }
  for (std::size_t j = 0; j < box.corners.size(); ++j) {
    if (!model_.cone(j) || !shared(j, box) || kept[j]) continue;
    RowId id;
    id.kind = RowKind::range_cone;
    id.corner = static_cast<int>(j);
    id.angle = 0.5 * model_.theta(j);
    id.in.at = box.corners[j].k2;
    id.out.at = box.corners[j].k1 - box.corners[j].d2;
    add_range_cone(id, box);
  }
}

void Programme::add_range_cone(const RowId& id, const Box& box) {
  const auto j = static_cast<std::size_t>(id.corner);
  const RangeRow row = range_row(box, j, id.in, id.out, model_.weight_in(j, id.angle), model_.weight_out(j, id.angle));
  std::vector<int> columns{excess(), delay_column(j), delay_column(j) + 1};
  std::vector<double> values{-1.0, row.on_delay, row.on_sample};
  for (int i = 0; i <= box.order; ++i) {
    columns.push_back(i), values.push_back(row.taps[static_cast<std::size_t>(i)]);
  }
  add(columns, values, -COIN_DBL_MAX, model_.error_bound(j) * (1.0 + slack_) - row.constant, id);
}

bool Programme::known_cone(const RowId& id) const {
  const auto same = [](const Tangent& a, const Tangent& b) {
    return a.at == b.at && a.after == b.after && a.high == b.high;
  };
  return std::any_of(ids_.begin() + base_rows_, ids_.end(), [&](const RowId& old) {
    return old.kind == id.kind && old.corner == id.corner && std::abs(old.angle - id.angle) < 1e-11 &&
           same(old.in, id.in) && same(old.out, id.out);
  });
}

void Programme::cut_ranges(std::size_t j, const Filter& filter, const Box& box, double allowed, bool& added) {
  const HighestTangents at = highest_tangents(filter, box, j, delay(j), sample(j));
  const double p = at.distance_in * model_.scale_in(j), q = at.distance_out * model_.scale_out(j);
  const double theta = model_.theta(j), inside = 1e-12;
  RowId id;
  id.kind = RowKind::range_cone;
  id.corner = static_cast<int>(j);
  id.in = at.in, id.out = at.out;
  // Only cuts that grow with both distances hold.
  id.angle = std::clamp(std::atan2(q * std::sin(theta), p + q * std::cos(theta)),
                        theta - 0.5 * std::numbers::pi + inside, 0.5 * std::numbers::pi - inside);
  const double value = p * std::cos(id.angle) + q * std::cos(theta - id.angle);
  if (value <= model_.error_bound(j) * (1.0 + broken()) + 1e-13 + std::max(allowed, 0.0) * (1.0 + slack)) return;
  if (known_cone(id)) return;  // the programme's own tolerance
  add_range_cone(id, box);
  added = true;
}

}  // namespace accdec::exact
