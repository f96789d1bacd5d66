#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/plot/figure.hpp>
#include <accdec/study/column_titles.hpp>
#include <accdec/study/point_columns.hpp>
#include <accdec/study/study_figure_completion.hpp>

namespace accdec {
namespace {

using Kind = StudyFigure::Kind;

/// A varied quantity: the cases, or a variation.
struct Varied {
  std::string name;
  std::vector<double> numbers;     ///< of a variation: distinct values in order
  std::vector<std::string> texts;  ///< as in the table
  bool drawn = false;              ///< drawn at random from a range: the values are only those at its ends

  bool varies() const { return drawn || texts.size() > 1; }
};

std::vector<Varied> axes_of(const Study& study, bool grid) {
  std::vector<Varied> axes;
  if (study.points().cases().size() > 1) axes.push_back({"case", {}, study.points().cases(), false});
  for (const study::Variation& v : study.points().variations()) {
    Varied axis{v.name, {}, {}, !grid && v.range};
    for (const double value : v.values) {
      if (std::find(axis.numbers.begin(), axis.numbers.end(), value) != axis.numbers.end()) continue;
      axis.numbers.push_back(value);
      axis.texts.push_back(batch::Row(value).dump());
    }
    axes.push_back(std::move(axis));
  }
  return axes;
}

const Varied* find_varied(const std::vector<Varied>& axes, const std::string& name) {
  const auto found = std::find_if(axes.begin(), axes.end(), [&](const Varied& a) { return a.name == name; });
  return found == axes.end() ? nullptr : &*found;
}

/// Whether a column of points, or one that every study has, is a text.
bool is_text(const std::string& column) {
  constexpr std::array<std::string_view, 4> of_all{"case", "point", "reason", "best_shape"};
  if (std::find(of_all.begin(), of_all.end(), column) != of_all.end()) return true;
  const study::PointColumn* found = study::find_point_column(column);
  return found != nullptr && found->words;
}

std::string values_text(const Varied& axis) {
  if (axis.numbers.empty()) return fmt::format("\"{}\"", fmt::join(axis.texts, "\", \""));
  constexpr std::size_t shown = 12;
  if (axis.numbers.size() <= shown) return fmt::format("{}", fmt::join(axis.numbers, ", "));
  const auto first = axis.numbers.begin();
  return fmt::format("{}, ... {} ({} values)", fmt::join(first, first + shown, ", "), axis.numbers.back(),
                     axis.numbers.size());
}

/// Spells a condition on an axis as the table does.
std::optional<FigureFault> check_condition(std::pair<std::string, std::string>& condition, const Varied& axis) {
  auto& [name, text] = condition;
  if (axis.drawn)
    return FigureFault{"where", fmt::format("`{}` cannot be fixed: a Latin hypercube draws it at random", name)};
  if (axis.numbers.empty() && std::find(axis.texts.begin(), axis.texts.end(), text) != axis.texts.end()) return {};
  double wanted = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), wanted);
  if (error == std::errc() && end == text.data() + text.size()) {
    for (std::size_t i = 0; i < axis.numbers.size(); ++i) {
      // Values of a range are seldom equal to the decimals that a user writes.
      if (std::abs(axis.numbers[i] - wanted) > 1e-9 * std::abs(wanted)) continue;
      text = axis.texts[i];
      return {};
    }
  }
  return FigureFault{"where", fmt::format("`{}` never is {}; it takes {}", name, text, values_text(axis))};
}

bool fixed(const StudyFigure& figure, const std::string& name) {
  return std::any_of(figure.where.begin(), figure.where.end(), [&](const auto& w) { return w.first == name; });
}

std::optional<FigureFault> check_scale(const char* key, const char* log_key, const std::string& column, bool log,
                                       const std::vector<Varied>& axes) {
  if (is_text(column))
    return FigureFault{key, fmt::format("`{}` is a text; the axis of a figure needs numbers", column)};
  const Varied* axis = find_varied(axes, column);
  if (!log || axis == nullptr) return {};
  const auto low = std::min_element(axis->numbers.begin(), axis->numbers.end());
  if (low == axis->numbers.end() || *low > 0.0) return {};
  return FigureFault{log_key,
                     fmt::format("`{}` takes the value {}, which a logarithmic axis does not have", column, *low)};
}

std::optional<FigureFault> check_labels(const StudyFigure& figure, std::size_t curves) {
  if (curves > most_lines) {
    const bool family = figure.kind == Kind::family;
    return FigureFault{
        family ? "family" : "y",
        fmt::format("{} curves are too many to be told apart; a figure has at most {}{}", curves, most_lines,
                    family ? fmt::format(": vary `{}` in fewer steps, or draw a heat map", figure.family) : "")};
  }
  if (figure.labels.empty() || figure.labels.size() == curves) return {};
  return FigureFault{"labels", fmt::format("{} label{} for {} curve{}; give one each, or none", figure.labels.size(),
                                           figure.labels.size() == 1 ? "" : "s", curves, curves == 1 ? "" : "s")};
}

/// The axes of a heat map.
std::optional<FigureFault> check_heat(const StudyFigure& figure, const std::vector<Varied>& axes, bool grid) {
  if (figure.y.size() > 1) return FigureFault{"y", "a heat map has one `y`"};
  const bool words = is_text(figure.z);
  if (!words && !grid)
    return FigureFault{"kind",
                       "a Latin hypercube has no grid, which a heat map of numbers needs; its points can be drawn as "
                       "a curve, which draws no lines here"};
  for (const auto& [key, column] : {std::pair{"x", figure.x}, std::pair{"y", figure.y.front()}}) {
    if (!words && find_varied(axes, column) == nullptr)
      return FigureFault{
          key, fmt::format("`{}` is not varied; the axes of a heat map are two of the study's variations", column)};
  }
  if (figure.x == figure.y.front()) return FigureFault{"y", "a heat map needs two different axes"};
  return {};
}

}  // namespace

std::optional<FigureFault> complete_study_figure(StudyFigure& figure, const Study& study, bool grid) {
  const std::vector<Varied> axes = axes_of(study, grid);
  for (auto& condition : figure.where) {
    const Varied* axis = find_varied(axes, condition.first);
    if (axis == nullptr) continue;
    if (auto fault = check_condition(condition, *axis)) return fault;
  }
  if (figure.kind == Kind::pareto) return check_labels(figure, figure.y.size());
  const bool heat = figure.kind == Kind::heat;
  if (auto fault = check_scale("x", "log_x", figure.x, figure.log_x, axes)) return fault;
  for (const std::string& y : figure.y) {
    if (auto fault = check_scale("y", "log_y", y, figure.log_y, axes)) return fault;
  }
  if (heat) {
    if (auto fault = check_heat(figure, axes, grid)) return fault;
    figure.excess = std::any_of(study.ratios.begin(), study.ratios.end(),
                                [&](const StudyRatio& r) { return r.name == figure.z && r.excess; });
  }
  figure.points_only = !grid;

  const Varied* across = find_varied(axes, figure.x);
  std::vector<const Varied*> open;
  for (const Varied& axis : axes) {
    const bool shown = axis.name == figure.x || (figure.kind == Kind::family && axis.name == figure.family) ||
                       (heat && axis.name == figure.y.front());
    if (axis.varies() && !shown && !fixed(figure, axis.name) && (grid || axis.name == "case")) open.push_back(&axis);
  }
  // No two rows have the same index. A computed column can stand for one variation, as in y over x.
  if (figure.x == "index") open.clear();
  if (across == nullptr && grid && !open.empty() && open.back()->name != "case") open.pop_back();
  if (!open.empty()) {
    const Varied& axis = *open.front();
    const std::string example =
        axis.numbers.empty() ? fmt::format("\"{}\"", axis.texts.front()) : fmt::format("{}", axis.numbers.front());
    return FigureFault{"where", fmt::format("`{0}` takes {1} values, but is neither on the figure nor fixed; fix it, "
                                            "as by where = {{ \"{0}\" = {2} }}{3}",
                                            axis.name, axis.texts.size(), example,
                                            figure.kind == Kind::curve ? ", or draw a family over it" : "")};
  }
  if (heat) {
    if (!figure.labels.empty()) return FigureFault{"labels", "labels name curves; a heat map has none"};
    return {};
  }
  if (figure.kind == Kind::curve) return check_labels(figure, figure.y.size());
  figure.family_unit = unit_in(figure.family, study);
  const Varied* family = find_varied(axes, figure.family);
  if (family == nullptr) return {};
  if (family->drawn)
    return FigureFault{
        "family",
        fmt::format("`{}` is drawn at random from a range; a family needs a quantity of few values", family->name)};
  for (const std::string& text : family->texts) {
    const bool counts = std::none_of(figure.where.begin(), figure.where.end(),
                                     [&](const auto& w) { return w.first == family->name && w.second != text; });
    if (counts) figure.members.push_back(text);
  }
  return check_labels(figure, figure.members.size());
}

}  // namespace accdec
