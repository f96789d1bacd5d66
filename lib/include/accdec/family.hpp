// Families of filters that controllers have, and the best member for a task.
#pragma once

#include <array>
#include <atomic>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <accdec/filter.hpp>
#include <accdec/result.hpp>
#include <accdec/task.hpp>

namespace accdec {

/// The real parameter of a family, in a scale in which every tap is monotone before the taps are divided by their sum.
struct RealParameter {
  double (*low)(int order);  ///< the least value; may itself be left out, see `open_low`
  double high;               ///< the largest value, for all orders
  bool open_low;             ///< the shape does not exist at `low`
  /// Taps before they are divided by their sum. @param order  of the shape, without pairs
  std::vector<double> (*taps)(int order, double value);
  void (*set)(FilterSpec& spec, double value);  ///< for the spec's order
};

/// A family of filters that controllers have: one shape, with or without pairs of impulses behind it. Its members are
/// the filters of every order, of every whole length of its averages or of every value of its real parameter.
struct Family {
  std::string_view name;  ///< "boxcar", "averages-zv", ...: columns and options
  std::string title;      ///< "three averages, ZV", by shape_title: tables and figures
  Shape shape;
  int pairs;         ///< see FilterSpec
  double outer;      ///< see FilterSpec
  int averages = 0;  ///< 1 to 3: members are the cascades of this many moving averages; 0: of none
  int least_order = 0;
  std::optional<RealParameter> parameter{};

  /// The member of these averages with these pairs behind them. @param lengths  longest first, `averages` of them
  FilterSpec member(std::span<const int> lengths, int pair_delay = 0) const;
};

/// Every family, in the order of tables and figures.
std::span<const Family> families();
/// Null for a name that is none.
const Family* find_family(std::string_view name);
/// The family that a filter is a member of: an average written as `averages` of one length, too. Null for filters of no
/// family: taps, more than three averages.
const Family* family_of(const FilterSpec& spec);

/// Visits the members of one order, those of a real parameter by one spec for all of its values; stops when the visitor
/// says false.
/// @param order  of the filter, pairs included
/// @param every  >= 1: steps of the second average's lengths, which are 1, 2, 2 + every, 2 + 2 every ..
/// @param visit  the spec and the lengths of its averages, longest first, empty for a family of none
using MemberVisitor = std::function<bool(const FilterSpec& spec, std::span<const int> lengths)>;
void visit_members(const Family& family, int order, int every, const MemberVisitor& visit);

/// The best member of a family for one task.
struct FamilyResult {
  std::optional<FilterSpec>
      spec;             ///< the filter in the words of a task file; none when no order within the task's bounds will do
  DesignResult result;  ///< feasible (the family's best, verified by simulation), infeasible or failed; its task has
                        ///< the filter in place
};

/// Whether no corner's legs overlap: the machine stops at every corner.
bool stops_exactly(const DesignResult& result);

/// The least cost (see Objective) of one family under a task's limits, over all orders within the task's bounds and all
/// values of the family's parameters. Each corner has the smallest delay at which its error bound and all limits hold.
/// Whole parameters (ramp, lengths, delay of a pair) are enumerated. A real one (cut-off, alpha, ratio) is searched by
/// branch and bound, down to 1e-8 of its range. Only lower bounds exclude orders, delays and responses. Among equal
/// costs the lowest order counts. Pairs of impulses cancel a vibration, so families with them need a task with modes.
/// If two averages hold the limits, the search ends at `hopeless_factor` times their cost. The task's own filter, if
/// any, is ignored. Given delays stay.
///
/// @param seconds  of wall time: what is best by then is the answer, and its message says that the search was not ended
FamilyResult best_member(const Task& task, const Family& baseline, double seconds = unlimited);
/// All of them, in their order.
/// @param seconds  of wall time: a family that is not searched to the end by then is without a filter (status failed)
/// @param cancel   ends the search as the time does; null: nothing does
std::vector<FamilyResult> best_members(const Task& task, double seconds = unlimited,
                                       const std::atomic<bool>* cancel = nullptr);

/// No family this many times slower than two averages is of interest to anybody; some (exponentials under a jerk limit)
/// would be searched for minutes.
inline constexpr double hopeless_factor = 3.0;

}  // namespace accdec
