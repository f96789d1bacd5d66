#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <accdec/family.hpp>
#include <accdec/filter.hpp>
#include <accdec/motion/windows.hpp>

namespace accdec {
namespace {

using std::numbers::pi;

/// Longer exponentials end in taps below 1e-9 of the first: those of a lower order do as well.
constexpr double most_time_constants = 21.0;

double zero(int) {
  return 0.0;
}

/// One value of a real parameter at every tap.
template <class Tap>
std::vector<double> taps_of(int order, Tap tap) {
  std::vector<double> taps(static_cast<std::size_t>(order) + 1);
  for (int i = 0; i <= order; ++i) taps[static_cast<std::size_t>(i)] = tap(i);
  return taps;
}

/// Time constants that an exponential is long; below 0 it rises.
const RealParameter time_constants{
    [](int order) { return -std::min(most_time_constants, std::log(exponential_ratio_max) * std::max(1, order)); },
    most_time_constants, false,
    [](int order, double value) {
      return taps_of(order, [=](int i) { return std::exp(-value * i / std::max(1, order)); });
    },
    [](FilterSpec& spec, double value) {
      spec.ratio = std::min(std::exp(-value / std::max(1, spec.order)), exponential_ratio_max);
    }};

const RealParameter alpha{
    zero, gaussian_alpha_max, false,
    [](int order, double value) { return taps_of(order, [=](int i) { return gaussian_window(i, order, value); }); },
    [](FilterSpec& spec, double value) { spec.alpha = value; }};

/// A sinc's cut-off times its order: 2 puts its first zeros on the window's ends.
const RealParameter cutoff{zero, 2.0, true,
                           [](int order, double value) {
                             return taps_of(order, [=](int i) {
                               const double y = pi * value * (i - 0.5 * order) / order;
                               return std::max(0.0, blackman_window(i, order)) *
                                      (y == 0.0 ? 1.0 : std::max(0.0, std::sin(y) / y));
                             });
                           },
                           [](FilterSpec& spec, double value) { spec.cutoff = value / spec.order; }};

/// All families of one shape.
struct Kind {
  std::string_view name;
  Shape shape;
  int averages;
  int least_order;
  std::optional<RealParameter> parameter;
  std::array<std::string_view, 4> with_shapers;  ///< names of the families with each of shaper_list; empty: none
};

const std::array<Kind, 9> kinds{{
    {"boxcar", Shape::boxcar, 1, 0, {}, {"boxcar-zv", "boxcar-zvd", "boxcar-mzv", "boxcar-ei"}},
    {"trapezoid", Shape::trapezoid, 2, 0, {}, {"trapezoid-zv", "trapezoid-zvd", "trapezoid-mzv", "trapezoid-ei"}},
    {"averages", Shape::averages, 3, 0, {}, {"averages-zv", "averages-zvd"}},
    {"s-curve", Shape::s_curve, 0, 2, {}, {}},
    {"hann", Shape::hann, 0, 2, {}, {}},
    {"blackman", Shape::blackman, 0, 2, {}, {}},
    {"blackman-sinc", Shape::blackman_sinc, 0, 2, cutoff, {}},
    {"gaussian", Shape::gaussian, 0, 1, alpha, {}},
    {"exponential", Shape::exponential, 0, 0, time_constants, {"exponential-zv", "exponential-zvd"}},
}};

std::vector<Family> make_families() {
  std::vector<Family> all;
  const auto shapers = shaper_list();
  for (std::size_t s = 0; s <= shapers.size(); ++s) {
    const int pairs = s == 0 ? 0 : shapers[s - 1].pairs;
    const double outer = s == 0 ? zvd_outer : shapers[s - 1].outer;
    for (const Kind& kind : kinds) {
      const std::string_view name = s == 0 ? kind.name : kind.with_shapers[s - 1];
      if (name.empty()) continue;
      std::string title = shape_title(kind.shape, pairs, outer);
      // Here there are always three.
      if (kind.shape == Shape::averages) title.replace(0, info(kind.shape).title.size(), "three averages");
      all.push_back(
          {name, std::move(title), kind.shape, pairs, outer, kind.averages, kind.least_order, kind.parameter});
    }
  }
  return all;
}

template <class Condition>
const Family* first_family(Condition condition) {
  const auto all = families();
  const auto found = std::find_if(all.begin(), all.end(), condition);
  return found == all.end() ? nullptr : &*found;
}

/// Cascades of an order, pairs left aside, longest average first.
bool visit_cascades(const Family& family, int order, int pair_delay, int every, const MemberVisitor& visit) {
  const auto offer = [&](std::initializer_list<int> lengths) {
    const std::span<const int> all(lengths.begin(), lengths.size());
    return visit(family.member(all, pair_delay), all);
  };
  if (family.averages == 1) return offer({order + 1});
  const auto next = [every](int taps) { return taps + (taps == 0 ? 1 : every); };
  if (family.averages == 2) {
    for (int b = 0; b <= order / 2; b = next(b)) {
      if (!offer({order - b + 1, b + 1})) return false;
    }
    return true;
  }
  for (int c = 0; 3 * c <= order; c = next(c)) {
    for (int b = c; 2 * b <= order - c; b += b == 0 ? 1 : every) {
      if (!offer({order - b - c + 1, b + 1, c + 1})) return false;
    }
  }
  return true;
}

}  // namespace

FilterSpec Family::member(std::span<const int> lengths, int pair_delay) const {
  FilterSpec spec{.kind = shape, .pairs = pairs, .pair_delay = static_cast<double>(pair_delay), .outer = outer};
  for (const int length : lengths) spec.order += length - 1;
  if (shape == Shape::trapezoid) spec.ramp = lengths[1] - 1;
  if (shape == Shape::averages) spec.lengths.assign(lengths.begin(), lengths.end());
  return spec;
}

std::span<const Family> families() {
  static const std::vector<Family> all = make_families();
  return all;
}

const Family* find_family(std::string_view name) {
  return first_family([=](const Family& f) { return f.name == name; });
}

const Family* family_of(const FilterSpec& spec) {
  Shape shape = spec.kind;
  if (shape == Shape::averages && spec.lengths.size() == 1) shape = Shape::boxcar;
  if (shape == Shape::averages && spec.lengths.size() == 2) shape = Shape::trapezoid;
  if (shape == Shape::averages && spec.lengths.size() > 3) return nullptr;
  const auto same_shaper = [&](const Family& f) {
    return f.pairs == spec.pairs && (spec.pairs < 2 || std::abs(f.outer - spec.outer) < 1e-9);
  };
  return first_family([&](const Family& f) { return f.shape == shape && same_shaper(f); });
}

void visit_members(const Family& family, int order, int every, const MemberVisitor& visit) {
  const int longest = family.pairs == 0 ? 0 : (order - family.least_order) / family.pairs;
  for (int delay = family.pairs == 0 ? 0 : 1; delay <= longest; ++delay) {
    const int own = order - family.pairs * delay;
    if (own < family.least_order) continue;
    if (family.averages > 0) {
      if (!visit_cascades(family, own, delay, every, visit)) return;
      continue;
    }
    FilterSpec spec = family.member({}, delay);
    spec.order = own;
    if (!visit(spec, {})) return;
  }
}

}  // namespace accdec
