#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <accdec/machine/limit_unit.hpp>
#include <accdec/plot/figure.hpp>

// Internal to this folder.

namespace accdec {

/// Bounds on a quantity, SI.
struct Bounds {
  double low = -unlimited, high = unlimited;
  bool any() const { return low > -unlimited || high < unlimited; }
};

/// The panel of one quantity: curves of the axes in the colour of the design, and of today's filter in grey below them.
/// Axes differ by their dashes. Every sample that binds is marked, or else the worst one. Limits far beyond all curves
/// are named in the title instead of flattening the curves; others have the names of their axes, if these differ.
class QuantityPanel {
 public:
  /// @param panel  empty, with its scale of time
  QuantityPanel(LimitUnit unit, std::string_view name, Panel panel);

  /// @param name  of the axis, empty if there is but one curve  @param dash  that tells it from other axes
  void add(const std::string& name, int dash, Series curve, const Series* before, const Bounds& bounds);

  Panel finished();

 private:
  struct Line {
    std::string name;
    double low, high, use = 0.0;
    std::pair<double, double> worst{};
  };

  void add_bars(const Series& curve, const Line& line);
  void name_bars(const Series& bars, double limit, const std::string& name);
  std::string bound() const;
  std::string uses() const;
  void add_limits();
  void name_limits();

  LimitUnit unit_;
  Panel panel_;
  std::vector<Line> lines_;
  std::vector<Series> curves_, bars_;
  std::vector<Note> notes_;
  double peak_ = 0.0;
};

}  // namespace accdec
