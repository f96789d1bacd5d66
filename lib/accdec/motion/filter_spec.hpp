#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <variant>
#include <vector>

#include <accdec/motion/filter.hpp>

namespace accdec {

/// The shapes a filter can be given as. Everything that depends on which there are takes it from `shape_list`.
enum class Shape { boxcar, trapezoid, averages, s_curve, hann, blackman, blackman_sinc, gaussian, exponential, taps };

/// A filter as a task describes it.
struct FilterSpec {
  Shape kind = Shape::boxcar;
  int order = 0;               ///< N of the shape without pairs; of averages and taps it follows from these
  double cutoff = 0.0;         ///< blackman-sinc: fraction of the Nyquist frequency
  int ramp = 0;                ///< trapezoid: taps in a ramp
  std::vector<double> taps{};  ///< Shape::taps
  std::vector<int> lengths{};  ///< averages: taps of each
  double ratio = 0.0;          ///< exponential: of each tap to the one before
  double alpha = 0.0;          ///< gaussian: half width over standard deviation
  int pairs = 0;               ///< any shape: of impulses behind it, see with_pairs: 0 none, 1 ZV, 2 ZVD
  int pair_delay = 0;          ///< samples between the impulses of a pair
};

/// One parameter of a shape beside its order: its key in [filter], where it is kept, what is allowed.
struct ShapeParameter {
  using Member = std::variant<int FilterSpec::*, double FilterSpec::*, std::vector<int> FilterSpec::*,
                              std::vector<double> FilterSpec::*>;
  std::string_view key;
  Member member;
  double low, high;  ///< of each number; the shape's maker may allow less
  bool open_low;     ///< low itself is not allowed
};

/// A shape: its name in task files ("boxcar", "s-curve", ...), whether `order` is given or follows from the parameter,
/// its parameter.
struct ShapeInfo {
  Shape shape;
  std::string_view name;
  bool has_order;
  std::optional<ShapeParameter> parameter;
  Filter (*make)(const FilterSpec&);  ///< without pairs; throws std::invalid_argument
};

/// Every shape, in the order of the enumeration, which is that of tables and messages.
std::span<const ShapeInfo> shape_list();
const ShapeInfo& info(Shape shape);
std::string_view to_string(Shape shape);
std::optional<Shape> shape_from_string(std::string_view name);

/// The filter, with its pairs. @throws std::invalid_argument as the shapes do.
Filter make_filter(const FilterSpec& spec);

/// What sets a filter apart within its family, in the words of task files: "ramp = 3", "lengths = [8, 5, 2], ZV 12";
/// may be empty.
std::string describe_parameters(const FilterSpec& spec);

}  // namespace accdec
