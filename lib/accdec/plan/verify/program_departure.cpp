#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <accdec/plan/verify/program_departure.hpp>
#include <accdec/simulate/joint_distance.hpp>

namespace accdec {
namespace {

constexpr double departure_rounding = 1e-9;  // m

/// The nearest point on the way from a to b, as a part of it, and its distance from the point, m.
std::pair<double, double> foot_on(const double* a, const double* b, const double* point, std::size_t n) {
  double along = 0.0, whole = 0.0, off = 0.0;
  for (std::size_t i = 0; i < n; ++i)
    along += (point[i] - a[i]) * (b[i] - a[i]), whole += (b[i] - a[i]) * (b[i] - a[i]);
  const double part = along / whole;
  for (std::size_t i = 0; i < n; ++i) {
    const double d = point[i] - a[i] - part * (b[i] - a[i]);
    off += d * d;
  }
  return {part, std::sqrt(off)};
}

/// Dwells by block, s.
std::map<std::size_t, double> dwells(const Toolpath& path) {
  std::map<std::size_t, double> sum;
  for (const auto& [block, time] : path.dwell) sum[block] += time;
  return sum;
}

bool same_time(double a, double b) {
  return std::abs(a - b) <= 1e-9 * b;
}

/// Walks along the commands that a programmed block became.
class DepartureWalk {
 public:
  DepartureWalk(const Toolpath& commanded, const Toolpath& programmed)
      : commanded_(commanded), programmed_(programmed), own_(dwells(commanded)), asked_(dwells(programmed)) {}

  std::string run() {
    for (std::size_t b = 0; b < programmed_.blocks(); ++b, ++at_) {
      if (const char* wrong = along(b)) return fmt::format("line {}: {}", programmed_.line[b], wrong);
      if (const char* wrong = end_of(b)) return fmt::format("line {}: {}", programmed_.line[b], wrong);
      ends_.push_back(static_cast<std::uint32_t>(at_));
    }
    return at_ == commanded_.blocks() ? "" : "the commands go on after the program's end";
  }
  const std::vector<std::uint32_t>& ends() const { return ends_; }

 private:
  /// To the command that ends where block b does.
  const char* along(std::size_t b) {
    const std::size_t n = programmed_.dimensions();
    const double *from = programmed_.point(b), *to = programmed_.point(b + 1);
    const double length = distance(from, to, n), speed = length / programmed_.duration[b];
    double passed = 0.0;  // part of the block
    for (;; ++at_) {
      if (at_ == commanded_.blocks()) return "the commands end before it does";
      if (commanded_.line[at_] != programmed_.line[b] || commanded_.rapid[at_] != programmed_.rapid[b])
        return "its commands are recorded as of another line or kind of move";
      const double* end = commanded_.programmed_point(at_ + 1);
      const auto [part, off] = foot_on(from, to, end, n);
      if (off > departure_rounding || part < passed - departure_rounding / length ||
          part > 1.0 + departure_rounding / length)
        return "the path leaves it";
      passed = part;
      const double piece = distance(commanded_.programmed_point(at_), end, n);
      if (piece > speed * commanded_.duration[at_] * (1.0 + 1e-5) + departure_rounding)
        return "is commanded above its programmed feed";
      if (distance(end, to, n) <= departure_rounding && !goes_on_to(to)) return nullptr;
      if (commanded_.joint[at_] != Joint::straight || own_.contains(at_)) return "the commands stop inside it";
      if (commanded_.tolerance[at_] < unlimited) return "a tolerance is recorded inside it";
    }
  }

  /// Whether the next command ends no farther from a block's end than this one: a step of feed may lie closer to the
  /// end than positions are rounded. The first command of the next block leads away from there.
  bool goes_on_to(const double* to) const {
    if (at_ + 1 == commanded_.blocks() || commanded_.joint[at_] != Joint::straight || own_.contains(at_)) return false;
    const std::size_t n = programmed_.dimensions();
    return distance(commanded_.programmed_point(at_ + 2), to, n) <=
           distance(commanded_.programmed_point(at_ + 1), to, n);
  }

  const char* end_of(std::size_t b) const {
    if (b + 1 < programmed_.blocks()) {
      if (programmed_.joint[b] == Joint::stop && commanded_.joint[at_] != Joint::stop)
        return "the program stops, the commands do not";
      if (programmed_.joint[b] != commanded_.joint[at_] || programmed_.inside_arc[b] != commanded_.inside_arc[at_])
        return "its end is recorded as of another kind";
      const double own = commanded_.tolerance[at_], asked = programmed_.tolerance[b];
      if (own > asked * (1.0 + 1e-9)) return "the tolerance is wider than the program's";
      if (own < asked * (1.0 - 1e-9)) return "the tolerance is narrower than the program's";
    }
    const auto own = own_.find(at_);
    const auto asked = asked_.find(b);
    const bool kept =
        asked == asked_.end() ? own == own_.end() : own != own_.end() && same_time(own->second, asked->second);
    return kept ? nullptr : "its dwell is not kept";
  }

  const Toolpath &commanded_, &programmed_;
  std::vector<std::uint32_t> ends_;  // commands at the ends of programmed blocks
  std::map<std::size_t, double> own_, asked_;
  std::size_t at_ = 0;  // of the commands
};

}  // namespace

std::string departs_from(const Toolpath& commanded, const Toolpath& programmed) {
  if (commanded.axes != programmed.axes) return "other axes move than in the program";
  if (distance(commanded.programmed_point(0), programmed.point(0), programmed.dimensions()) > departure_rounding)
    return "it begins elsewhere";
  if (!same_time(commanded.dwell_first, programmed.dwell_first)) return "the dwell before the first block is another";
  return DepartureWalk(commanded, programmed).run();
}

void take_arcs(Toolpath& commanded, const Toolpath& programmed) {
  commanded.arcs.clear();
  if (commanded.axes != programmed.axes) return;
  DepartureWalk walk(commanded, programmed);
  if (!walk.run().empty()) return;
  for (PathArc arc : programmed.arcs) {
    arc.first = arc.first > 0 ? walk.ends()[arc.first - 1] + 1 : 0;
    arc.last = walk.ends()[arc.last];
    commanded.arcs.push_back(arc);
  }
}

}  // namespace accdec
