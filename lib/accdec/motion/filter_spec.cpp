#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <type_traits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/filter.hpp>

namespace accdec {
namespace {

using Spec = FilterSpec;

constexpr std::array<ShaperInfo, 4> shapers{{{"zv", "ZV", 1, zvd_outer, 0.5},
                                             {"zvd", "ZVD", 2, zvd_outer, 0.5},
                                             {"mzv", "MZV", 2, 1.0 - std::numbers::sqrt2 / 2.0, 0.375},
                                             {"ei", "EI", 2, 0.25 * 1.05, 0.5}}};

/// Null without pairs.
const ShaperInfo* shaper_like(int pairs, double outer) {
  for (const ShaperInfo& shaper : shapers) {
    if (shaper.pairs == pairs && (pairs == 1 || std::abs(shaper.outer - outer) < 1e-9)) return &shaper;
  }
  return nullptr;
}

std::string_view title_like(int pairs, double outer) {
  const ShaperInfo* shaper = shaper_like(pairs, outer);
  return shaper != nullptr ? shaper->title : "three impulses";
}

const std::array<ShapeInfo, 10> shapes{{
    {Shape::boxcar, "boxcar", "average", true, {}, [](const Spec& s) { return boxcar(s.order); }},
    {Shape::trapezoid, "trapezoid", "two averages (trapezoidal acceleration, the industry's S-curve)", true,
     ShapeParameter{"ramp", &Spec::ramp, 0.0, 1e6, false}, [](const Spec& s) { return trapezoid(s.order, s.ramp); }},
    {Shape::averages, "averages", "averages in cascade", false,
     ShapeParameter{"lengths", &Spec::lengths, 1.0, 1e6, false}, [](const Spec& s) { return averages(s.lengths); }},
    {Shape::s_curve, "s-curve", "quintic S-curve (paper)", true, {}, [](const Spec& s) { return s_curve(s.order); }},
    {Shape::hann, "hann", "Hann", true, {}, [](const Spec& s) { return hann(s.order); }},
    {Shape::blackman, "blackman", "Blackman", true, {}, [](const Spec& s) { return blackman(s.order); }},
    {Shape::blackman_sinc, "blackman-sinc", "Blackman sinc", true,
     ShapeParameter{"cutoff", &Spec::cutoff, 0.0, 1.0, true},
     [](const Spec& s) { return blackman_sinc(s.order, s.cutoff); }},
    {Shape::gaussian, "gaussian", "Gaussian", true,
     ShapeParameter{"alpha", &Spec::alpha, 0.0, gaussian_alpha_max, false},
     [](const Spec& s) { return gaussian(s.order, s.alpha); }},
    {Shape::exponential, "exponential", "exponential", true,
     ShapeParameter{"ratio", &Spec::ratio, 0.0, exponential_ratio_max, true},
     [](const Spec& s) { return exponential(s.order, s.ratio); }},
    {Shape::taps, "taps", "free taps", false, ShapeParameter{"taps", &Spec::taps, 0.0, 1e300, false},
     [](const Spec& s) { return Filter(s.taps); }},
}};

}  // namespace

std::span<const ShapeInfo> shape_list() {
  return shapes;
}

const ShapeInfo& info(Shape shape) {
  return *std::find_if(shapes.begin(), shapes.end(), [=](const ShapeInfo& s) { return s.shape == shape; });
}

std::string_view to_string(Shape shape) {
  return info(shape).name;
}

std::optional<Shape> shape_from_string(std::string_view name) {
  for (const ShapeInfo& s : shapes) {
    if (s.name == name) return s.shape;
  }
  return std::nullopt;
}

std::span<const ShaperInfo> shaper_list() {
  return shapers;
}

const ShaperInfo* find_shaper(std::string_view name) {
  const auto* found = std::find_if(shapers.begin(), shapers.end(), [=](const ShaperInfo& s) { return s.name == name; });
  return found == shapers.end() ? nullptr : found;
}

const ShaperInfo* shaper_of(const FilterSpec& spec) {
  return shaper_like(spec.pairs, spec.outer);
}

Filter make_filter(const FilterSpec& spec) {
  const Filter filter = info(spec.kind).make(spec);
  return spec.pairs == 0 ? filter : with_pairs(filter, spec.pairs, spec.pair_delay, spec.outer);
}

std::string shape_title(Shape shape, int pairs, double outer) {
  const std::string_view title = info(shape).title;
  if (pairs == 0) return std::string(title);
  return fmt::format("{}, {}", title.substr(0, title.find(" (")), title_like(pairs, outer));
}

std::string describe_parameters(const FilterSpec& spec, Digits digits) {
  std::string text;
  const auto& parameter = info(spec.kind).parameter;
  if (parameter && spec.kind != Shape::taps) {
    const auto value = [&](auto member) {
      if constexpr (std::is_same_v<decltype(member), double FilterSpec::*>) {
        if (digits == Digits::four) return fmt::format("{:.4g}", spec.*member);
      }
      return fmt::format("{}", spec.*member);
    };
    text = fmt::format("{} = {}", parameter->key, std::visit(value, parameter->member));
  }
  if (spec.pairs > 0)
    text += fmt::format(
        "{}{} {}", text.empty() ? "" : ", ", title_like(spec.pairs, spec.outer),
        digits == Digits::four ? fmt::format("{:.9g}", spec.pair_delay) : fmt::format("{}", spec.pair_delay));
  return text;
}

}  // namespace accdec
