#include <algorithm>
#include <map>
#include <numeric>
#include <stdexcept>
#include <utility>

#include <accdec/nlp/cone_problem.hpp>

namespace accdec::nlp {
namespace {

void require(bool holds, const char* what) {
  if (!holds) throw std::invalid_argument(what);
}

bool all_inside(const std::vector<ConeData::Coefficient>& all, std::size_t rows, std::size_t columns) {
  return std::all_of(all.begin(), all.end(), [&](const ConeData::Coefficient& c) {
    return c.row >= 0 && c.row < static_cast<int>(rows) && c.column >= 0 && c.column < static_cast<int>(columns);
  });
}

}  // namespace

ConeProblem::ConeProblem(ConeData data) : data_(std::move(data)) {
  const int in_cones = std::accumulate(data_.cones.begin(), data_.cones.end(), 0);
  require(data_.linear >= 0 && std::all_of(data_.cones.begin(), data_.cones.end(), [](int n) { return n >= 2; }),
          "a cone has two rows at least");
  require(data_.linear + in_cones == static_cast<int>(data_.h.size()), "the cones' rows are not those of h");
  require(all_inside(data_.a, data_.b.size(), data_.c.size()) && all_inside(data_.g, data_.h.size(), data_.c.size()),
          "a coefficient is outside its matrix");
  // For each row of G: the problem's row of |u|^2 - t^2 <= 0, and the row of t >= 0 if it is a t.
  std::vector<std::pair<int, int>> rows_of(data_.h.size(), {-1, -1});
  int next = data_.linear, row = first_cone_row();
  for (const int n : data_.cones) {
    for (int i = 0; i < n; ++i) rows_of[static_cast<std::size_t>(next++)] = {row, i == 0 ? row + 1 : -1};
    row += 2;
  }
  std::map<std::pair<int, int>, int> slots;
  const auto place = [&](int at, int column, int slack, double value) {
    const auto [found, added] = slots.emplace(std::pair(at, column), static_cast<int>(pattern_.size()));
    if (added) pattern_.push_back({at, column});
    places_.push_back({found->second, slack, value});
  };
  for (const auto& c : data_.a) place(c.row, c.column, -1, c.value);
  for (const auto& c : data_.g) {
    const auto [quadratic, positive] = rows_of[static_cast<std::size_t>(c.row)];
    if (quadratic < 0) {
      place(static_cast<int>(data_.b.size()) + c.row, c.column, -1, c.value);
      continue;
    }
    // d(u^2) = -2 u G dx, d(-t^2) = 2 t G dx, dt = -G dx
    place(quadratic, c.column, c.row, positive < 0 ? -2.0 * c.value : 2.0 * c.value);
    if (positive >= 0) place(positive, c.column, -1, -c.value);
  }
}

int ConeProblem::num_rows() const {
  return first_cone_row() + 2 * static_cast<int>(data_.cones.size());
}

Bound ConeProblem::row_bound(int i) const {
  const int equations = static_cast<int>(data_.b.size());
  if (i < equations) return {data_.b[static_cast<std::size_t>(i)], data_.b[static_cast<std::size_t>(i)]};
  if (i < first_cone_row()) return {-infinity, data_.h[static_cast<std::size_t>(i - equations)]};
  const bool quadratic = (i - first_cone_row()) % 2 == 0;
  return quadratic ? Bound{-infinity, 0.0} : Bound{0.0, infinity};
}

std::vector<double> ConeProblem::slacks(std::span<const double> x) const {
  std::vector<double> s = data_.h;
  for (const auto& c : data_.g) s[static_cast<std::size_t>(c.row)] -= c.value * x[static_cast<std::size_t>(c.column)];
  return s;
}

double ConeProblem::objective(std::span<const double> x) const {
  return std::inner_product(x.begin(), x.end(), data_.c.begin(), 0.0);
}

void ConeProblem::gradient(std::span<const double>, std::span<double> g) const {
  std::copy(data_.c.begin(), data_.c.end(), g.begin());
}

void ConeProblem::rows(std::span<const double> x, std::span<double> c) const {
  std::fill(c.begin(), c.end(), 0.0);
  for (const auto& e : data_.a) c[static_cast<std::size_t>(e.row)] += e.value * x[static_cast<std::size_t>(e.column)];
  const std::vector<double> s = slacks(x);
  const std::size_t equations = data_.b.size(), linear = static_cast<std::size_t>(data_.linear);
  for (std::size_t i = 0; i < linear; ++i) c[equations + i] = data_.h[i] - s[i];
  std::size_t next = linear, row = equations + linear;
  for (const int n : data_.cones) {
    const double t = s[next];
    double square = 0.0;
    for (std::size_t i = 1; i < static_cast<std::size_t>(n); ++i) square += s[next + i] * s[next + i];
    c[row] = square - t * t;
    c[row + 1] = t;
    next += static_cast<std::size_t>(n);
    row += 2;
  }
}

void ConeProblem::jacobian(std::span<const double> x, std::span<double> values) const {
  std::fill(values.begin(), values.end(), 0.0);
  const std::vector<double> s = slacks(x);
  for (const Place& p : places_)
    values[static_cast<std::size_t>(p.slot)] += p.slack < 0 ? p.value : p.value * s[static_cast<std::size_t>(p.slack)];
}

}  // namespace accdec::nlp
