#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <accdec/exact/limit_model.hpp>
#include <accdec/verify.hpp>

namespace accdec::exact {

struct LimitModel::Granted {
  explicit Granted(const Task& written) : task(granted_limits(written)), model(task, nullptr) {}
  Task task;
  LimitModel model;
};

LimitModel::LimitModel(const Task& task)
    : granted_(std::make_unique<Granted>(task)),
      rows(task),
      chords(task, rows),
      tube(granted_->model.tube),
      ramps(task),
      task_(task) {}
LimitModel::LimitModel(const Task& granted, std::nullptr_t)
    : rows(granted), chords(granted, rows), tube(granted, rows), ramps(granted), task_(granted) {}
LimitModel::~LimitModel() = default;

const LimitModel& LimitModel::granted() const {
  return granted_ ? granted_->model : *this;
}

void LimitModel::follow_tolerances() {
  const Task now = granted_limits(task_);
  for (std::size_t j = 0; j < now.corners.size(); ++j) {
    granted_->task.corners[j].error_max = now.corners[j].error_max;
    granted_->task.corners[j].contour_max = now.corners[j].contour_max;
  }
}

double LimitModel::error_bound(std::size_t corner) const {
  const TaskCorner& c = task_.corners[corner];
  // Slightly less than what the simulation counts as zero, so that its rounding does not matter.
  return std::max(*c.error_max, 0.999 * position_floor) /
         (task_.sample_period * std::max(c.geometry().feed_in, c.geometry().feed_out));
}

bool LimitModel::contour(std::size_t corner) const {
  constexpr double beyond = 1e6;  // samples: longer than any blend
  return task_.corners[corner].contour_max && contour_bound(corner) < beyond;
}

double LimitModel::contour_bound(std::size_t corner) const {
  const TaskCorner& c = task_.corners[corner];
  // The part of leg 2 across leg 1 is precise for nearly collinear legs, too.
  const double sine = (c.geometry().direction_out + c.geometry().cos_interior() * c.geometry().direction_in).norm();
  return std::max(*c.contour_max, 0.999 * position_floor) /
         (sine * task_.sample_period * std::max(c.geometry().feed_in, c.geometry().feed_out));
}

double LimitModel::theta(std::size_t corner) const {
  const double c = cos_interior(corner);
  return std::atan2(std::sqrt(std::max(0.0, (1.0 - c) * (1.0 + c))), c);
}
double LimitModel::scale_in(std::size_t j) const {
  const Corner& c = task_.corners[j].geometry();
  return c.feed_in / std::max(c.feed_in, c.feed_out);
}
double LimitModel::scale_out(std::size_t j) const {
  const Corner& c = task_.corners[j].geometry();
  return c.feed_out / std::max(c.feed_in, c.feed_out);
}

double LimitModel::weight_in(std::size_t corner, double angle) const {
  return scale_in(corner) * std::cos(angle);
}
double LimitModel::weight_out(std::size_t corner, double angle) const {
  const double c = cos_interior(corner);
  return scale_out(corner) * (c * std::cos(angle) + std::sqrt(std::max(0.0, (1.0 - c) * (1.0 + c))) * std::sin(angle));
}

namespace {

/// The box's own bound on B_sample of the motion, as a row.
SparseRow response_row(const proof::Response& id, const Box& box, const ConvexRows& rows) {
  SparseRow row;
  row.of_motion = rows.servo();
  const auto k = static_cast<std::size_t>(id.sample);
  if (id.sample > 0 && id.sample <= box.order + rows.motion().order()) row.sums.emplace_back(id.sample, id.sign);
  row.constant = 1.0 - (id.sign > 0 ? box.tube.high[k] : -box.tube.low[k]);
  return row;
}

}  // namespace

SparseRow LimitModel::row(const proof::Row& id, const Box& box) const {
  if (const auto* tap = std::get_if<proof::TapDifference>(&id)) return rows.row(*tap, box);
  if (const auto* force = std::get_if<proof::EventForce>(&id)) return rows.row(*force, box);
  if (const auto* blend = std::get_if<proof::Blend>(&id)) return rows.row(*blend, box);
  if (const auto* reversal = std::get_if<proof::Reversal>(&id)) return rows.row(*reversal, box);
  if (const auto* response = std::get_if<proof::Response>(&id)) return response_row(*response, box, rows);
  if (const auto chord = chord_of(id)) return chords.row(*chord, box);
  throw std::logic_error("such a row is not sparse");
}

}  // namespace accdec::exact
