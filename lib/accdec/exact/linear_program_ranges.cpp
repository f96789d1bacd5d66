#include <algorithm>
#include <cmath>
#include <numbers>

#include <accdec/exact/linear_program.hpp>
#include <accdec/exact/range_cut.hpp>

// The part of the linear program that several corners share: their delays and samples as columns, and the bound that
// the target puts on all delays together.

namespace accdec::exact {

/// Sets the bounds of the columns and adds the rows that are not there yet.
void LinearProgram::prepare_ranges(const Box& box) {
  for (std::size_t j = 0; j < box.corners.size(); ++j) {
    const CornerBox& c = box.corners[j];
    const bool ranges = RowDrafts::shared(j, box) && model_.cone(j);
    lp_.set_column_bounds(drafts_.delay_column(j), 0.0, box.budget ? c.d2 - c.d1 : 0.0);
    lp_.set_column_bounds(drafts_.sample_column(j), 0.0, ranges ? c.k2 - c.k1 : 0.0);
  }
  if (!box.budget) return;
  if (!names_.known<proof::Budget>([](const proof::Budget&) { return true; })) {
    add(drafts_.budget(box), proof::Budget{});
  }
  for (std::size_t j = 0; j < box.corners.size(); ++j) {
    const auto of_corner = [&](const proof::RangeError& id) { return id.corner == static_cast<int>(j); };
    if (!model_.cone(j) || !RowDrafts::shared(j, box) || names_.known<proof::RangeError>(of_corner)) continue;
    proof::RangeError id{static_cast<int>(j), 0.5 * model_.theta(j), {}, {}};
    id.in.at = box.corners[j].k2;
    id.out.at = box.corners[j].k1 - box.corners[j].d2;
    add(drafts_.range_cone(id, box), id);
  }
}

void LinearProgram::cut_ranges(std::size_t j, const Filter& filter, const Box& box, double allowed, bool& added) {
  const HighestTangents at = highest_tangents(filter, box, j, delay(j), sample(j));
  const double p = at.distance_in * model_.scale_in(j), q = at.distance_out * model_.scale_out(j);
  const double theta = model_.theta(j), inside = 1e-12;
  proof::RangeError id{static_cast<int>(j), 0.0, at.in, at.out};
  // Only cuts that grow with both distances hold.
  id.angle = std::clamp(std::atan2(q * std::sin(theta), p + q * std::cos(theta)),
                        theta - 0.5 * std::numbers::pi + inside, 0.5 * std::numbers::pi - inside);
  const double value = p * std::cos(id.angle) + q * std::cos(theta - id.angle);
  if (value <= model_.error_bound(j) * (1.0 + broken()) + 1e-13 + std::max(allowed, 0.0) * (1.0 + slack)) return;
  const auto same = [&](const proof::RangeError& old) {
    return old.corner == id.corner && std::abs(old.angle - id.angle) < same_angle && old.in == id.in &&
           old.out == id.out;
  };
  if (names_.known<proof::RangeError>(same)) return;  // the linear program's own tolerance
  add(drafts_.range_cone(id, box), id);
  added = true;
}

}  // namespace accdec::exact
