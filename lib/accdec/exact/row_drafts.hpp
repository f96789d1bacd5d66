#pragma once

#include <vector>

#include <accdec/exact/limit_model.hpp>

// Internal to the exact method.

namespace accdec::exact {

/// The linear program meets limits within this tolerance, well below the verifier's 1e-9. So a limit used to its last
/// bit does not fall between a solution that verifies and a refutation.
inline constexpr double slack = 3e-10;

/// A row on its way into the linear program.
struct DraftRow {
  std::vector<int> columns;
  std::vector<double> values;
  double low = 0.0, high = 0.0;
  void clear() { columns.clear(), values.clear(); }
  void add(int column, double value) { columns.push_back(column), values.push_back(value); }
};

/// Writes limits as rows of the linear program. Its columns are the taps 0 .. largest order, the excess over the cones,
/// and for each corner d - d1 and k - k1. Every draft is valid until the next.
class RowDrafts {
 public:
  /// The reference is kept.
  /// @param slack  relative tolerance of every limit  @param window  the taps are those of a window
  RowDrafts(const LimitModel& model, int largest, double slack, bool window)
      : model_(model), largest_(largest), slack_(slack), window_(window) {}

  int excess() const { return largest_ + 1; }
  int delay_column(std::size_t j) const { return largest_ + 2 + 2 * static_cast<int>(j); }
  int sample_column(std::size_t j) const { return delay_column(j) + 1; }
  /// Whether the corner's delay and sample are columns in this box.
  static bool shared(std::size_t j, const Box& box) {
    return box.budget && box.ranges(j) && box.servo == nullptr;  // tangents behind a response are not known
  }
  /// Scales vibration rows to units of their bound, so that the linear program's tolerance is relative to it.
  double vibration_scale(const proof::Vibration& id) const;

  const DraftRow& sum_of_taps();
  const DraftRow& equal_taps(int one, int other);
  const DraftRow& response(int sample);
  /// @param both  bounded on both sides  @param soft  the excess may break it
  const DraftRow& limit(const SparseRow& row, double scale, bool both, bool soft = false);
  const DraftRow& cone(const proof::Error& id, const Box& box);
  /// Null: it says nothing in this box.
  const DraftRow* contour(const proof::Contour& id, const Box& box);
  const DraftRow& range_cone(const proof::RangeError& id, const Box& box);
  const DraftRow& vibration(const proof::Vibration& id, const Box& box);
  const DraftRow& budget(const Box& box);
  /// Null: it says nothing in this box.
  const DraftRow* width(const proof::Width& id, const Box& box);

  // The row of a cut in a new box; null: it says nothing there. A chord becomes that of the new box.
  const DraftRow* again(const proof::Error& id, const Box& box);
  const DraftRow* again(const proof::RangeError& id, const Box& box);
  const DraftRow* again(const proof::Blend& id, const Box& box);
  const DraftRow* again(const proof::Reversal& id, const Box& box);
  const DraftRow* again(const proof::Vibration& id, const Box& box);
  const DraftRow* again(Chord& chord, const Box& box);

 private:
  template <class BlendRow>
  const DraftRow* again_at_blend(const BlendRow& id, const Box& box);
  void clear_command();
  /// The coefficients of the command's taps in `on_command_`, as columns of the draft.
  void add_command();
  void add_columns(const std::vector<double>& taps);

  const LimitModel& model_;
  const int largest_;
  const double slack_;
  const bool window_;
  DraftRow draft_;
  std::vector<double> on_command_, on_tap_;
};

}  // namespace accdec::exact
