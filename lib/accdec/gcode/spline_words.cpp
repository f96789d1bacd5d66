#include <cmath>

#include <accdec/gcode/spline_words.hpp>

namespace accdec {
namespace {

constexpr std::uint32_t of_point = letter_bit('X') | letter_bit('Y');
constexpr int largest_order = 32;

}  // namespace

std::uint32_t SplineWords::block(const Words& words, int tenths, Plane plane, bool absolute, const ProgramPoint& to,
                                 std::size_t column) {
  if (plane != Plane::xy) source_.fail(column, "splines lie in the XY plane: G17 must come first");
  if ((words.present() & Words::axes & ~of_point) != 0U) {
    source_.fail(words.first_column(Words::axes & ~of_point), "splines move X and Y only");
  }
  if (tenths == 50 || tenths == 51) {
    if (!open_.empty()) leave(column);
    tenths == 50 ? cubic(words, to, column) : quadratic(words, to, column);
    return of_point | letter_bit('I') | letter_bit('J') | (tenths == 50 ? letter_bit('P') | letter_bit('Q') : 0U);
  }
  continues_ = false;
  if (tenths == 53) {
    close(column);
    return 0;
  }
  if (!absolute) source_.fail(column, "control points of G5.2 are absolute: G90 must come first");
  control_point(words, to, column);
  return of_point | letter_bit('P') | letter_bit('L');
}

void SplineWords::leave(std::size_t column) {
  continues_ = false;
  if (!open_.empty()) source_.fail(column, "G5.3 must close the control points of G5.2 before anything else moves");
}

void SplineWords::cubic(const Words& words, const ProgramPoint& to, std::size_t column) {
  if (!words.has('P') || !words.has('Q')) source_.fail(column, "G5 needs both P and Q");
  if (words.has('I') != words.has('J')) source_.fail(column, "G5 needs both I and J, or neither");
  if (!words.has('I') && !continues_) source_.fail(column, "the first G5 needs I and J");
  const double x = state_.position[0], y = state_.position[1], unit = state_.unit;
  const double i = words.has('I') ? words['I'] * unit : next_i_, j = words.has('J') ? words['J'] * unit : next_j_;
  const double p = words['P'] * unit, q = words['Q'] * unit;
  state_.spline({{x, y}, {x + i, y + j}, {to[0] + p, to[1] + q}, {to[0], to[1]}}, 4, column);
  continues_ = true;
  next_i_ = -p;
  next_j_ = -q;
}

void SplineWords::quadratic(const Words& words, const ProgramPoint& to, std::size_t column) {
  if (!words.has('I') || !words.has('J')) source_.fail(column, "G5.1 needs both I and J");
  const double x = state_.position[0], y = state_.position[1], unit = state_.unit;
  state_.spline({{x, y}, {x + words['I'] * unit, y + words['J'] * unit}, {to[0], to[1]}}, 3, column);
  continues_ = false;
}

void SplineWords::control_point(const Words& words, const ProgramPoint& to, std::size_t column) {
  const bool point = words.has('X') && words.has('Y');
  if (words.has('X') != words.has('Y')) source_.fail(column, "a control point of G5.2 needs both X and Y");
  if (words.has('P') && !(words['P'] > 0.0)) source_.fail(words.column('P'), "a weight P must be above 0");
  if (open_.empty()) {
    order_ = 3;
    open_.push_back({state_.position[0], state_.position[1], !point && words.has('P') ? words['P'] : 1.0});
  } else if (!point && words.has('P')) {
    source_.fail(words.column('P'), "P without X and Y is the weight of the first control point only");
  }
  if (words.has('L')) {
    const double l = words['L'];
    if (!(l >= 1.0 && l <= largest_order && l == std::floor(l)))
      source_.fail(words.column('L'), "the order L must be a whole number from 1 to " + std::to_string(largest_order));
    order_ = std::max(3, static_cast<int>(l));
  }
  if (!point) return;
  if (!words.has('P')) source_.fail(column, "a control point of G5.2 needs its weight P");
  open_.push_back({to[0], to[1], words['P']});
}

void SplineWords::close(std::size_t column) {
  if (open_.empty()) source_.fail(column, "G5.3 closes control points that G5.2 must begin");
  if (static_cast<int>(open_.size()) < order_) {
    source_.fail(column, "a spline of order " + std::to_string(order_) + " needs as many control points, there are " +
                             std::to_string(open_.size()));
  }
  state_.spline(open_, order_, column);
  open_.clear();
}

}  // namespace accdec
