#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

#include <accdec/motion/shapes.hpp>
#include <accdec/task/task.hpp>

namespace accdec {
namespace {

constexpr std::array<std::pair<Shape, std::string_view>, 7> shape_names{{{Shape::boxcar, "boxcar"},
                                                                         {Shape::trapezoid, "trapezoid"},
                                                                         {Shape::s_curve, "s-curve"},
                                                                         {Shape::hann, "hann"},
                                                                         {Shape::blackman, "blackman"},
                                                                         {Shape::blackman_sinc, "blackman-sinc"},
                                                                         {Shape::taps, "taps"}}};

}  // namespace

std::string_view to_string(Shape shape) {
  return std::find_if(shape_names.begin(), shape_names.end(), [=](const auto& s) { return s.first == shape; })->second;
}

std::optional<Shape> shape_from_string(std::string_view name) {
  for (const auto& [shape, text] : shape_names) {
    if (text == name) return shape;
  }
  return std::nullopt;
}

Filter make_filter(const FilterSpec& spec) {
  switch (spec.kind) {
    case Shape::boxcar: return boxcar(spec.order);
    case Shape::trapezoid: return trapezoid(spec.order, spec.ramp);
    case Shape::s_curve: return s_curve(spec.order);
    case Shape::hann: return hann(spec.order);
    case Shape::blackman: return blackman(spec.order);
    case Shape::blackman_sinc: return blackman_sinc(spec.order, spec.cutoff);
    case Shape::taps: return Filter(spec.taps);
  }
  throw std::invalid_argument("unknown filter shape");
}

}  // namespace accdec
