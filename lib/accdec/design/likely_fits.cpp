#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include <accdec/design/likely_fits.hpp>

namespace accdec {
namespace {

constexpr double rare = 3.0;  // of a logarithm of likelihoods, twice: commands that begin or end between samples
constexpr double longest_first = 1e-3;  // the same; of readings that fit alike, the longest move stands first
constexpr double faster = 1.05;         // a move faster by this factor than the log's constant speed is another reading

double norm(const std::vector<double>& way) {
  double sum = 0.0;
  for (const double w : way) sum = std::hypot(sum, w);
  return sum;
}

bool has_real_number(SettingFamily family) {
  return family != SettingFamily::averages && family != SettingFamily::shaper && family != SettingFamily::one_pole;
}

/// Whether two members have the same taps, up to rounding. A real number is fitted, so that its taps are only near: a
/// Gaussian of little alpha is the average that it ends as.
bool same_filter(const FittedFilter& a, const Filter& of_a, const FittedFilter& b, const Filter& of_b) {
  constexpr double near = 0.01, exact = 1e-6;
  if (a.family == SettingFamily::one_pole && b.family == a.family)
    return std::abs(a.time_constant - b.time_constant) + std::abs(a.second_constant - b.second_constant) <
           near * (a.time_constant + a.second_constant);
  const double allowed =
      has_real_number(a.family) || has_real_number(b.family) ? near * std::ranges::max(of_a.taps()) : exact;
  return std::ranges::equal(of_a.taps(), of_b.taps(), [=](double x, double y) { return std::abs(x - y) < allowed; });
}

/// Whether both have one name, up to a real number.
bool same_name(const FittedFilter& a, const FittedFilter& b) {
  return a.family == b.family && a.filter.lengths == b.filter.lengths && a.filter.pairs == b.filter.pairs &&
         a.filter.outer == b.filter.outer && a.filter.pair_delay == b.filter.pair_delay;
}

}  // namespace

std::vector<LoggedMove> moves_of(const CommandFit& fit) {
  std::vector<LoggedMove> moves;
  for (std::size_t leg = 0; leg < fit.first.size(); ++leg) {
    const auto column = static_cast<Eigen::Index>(leg);
    LoggedMove move{.first = fit.first[leg], .samples = fit.count[leg]};
    double first = 0.0, last = 0.0;  // parts of steps beside the full ones
    if (fit.ends == Ends::last) last = fit.parts(0, column);
    if (fit.ends == Ends::both) first = fit.parts(0, column), last = fit.parts(1, column);
    if (fit.ends == Ends::between && fit.parts(0, column) > 0.0)
      last = fit.parts(0, column), first = 1.0 - last, --move.samples, ++move.first;
    const Eigen::VectorXd step = fit.coefficients.row(column + 1) / fit.count[leg];
    const Eigen::VectorXd way = (move.samples + first + last) * step;
    if (first > 0.0) move.first_step = first, ++move.samples, --move.first;
    if (last > 0.0) move.last_step = last, ++move.samples;
    move.way.assign(way.data(), way.data() + way.size());
    moves.push_back(std::move(move));
  }
  return moves;
}

double LoggedMove::feed(double period) const {
  return norm(way) / ((samples - 2.0 + first_step + last_step) * period);
}

bool FitList::possible(const std::vector<LoggedMove>& moves) const {
  if (options_.feed) {
    const double way = norm(moves.front().way), length = way / moves.front().feed(task_.sample_period);
    if (std::abs(length - way / *options_.feed) > task_.sample_period) return false;
  }
  for (const LoggedMove& move : moves) {
    const double feed = move.feed(task_.sample_period);
    if (feed <= faster * command_.step / task_.sample_period) continue;
    if (feed > fastest_move) return false;
    for (std::size_t a = 0; a < log_.axes.size(); ++a) {
      for (const Axis& axis : task_.machine.axes) {
        const bool same = axis.name == log_.axes[a] || task_.machine.axes.size() == 1;
        if (same && feed * std::abs(move.way[a]) > faster * axis.velocity_max * norm(move.way)) return false;
      }
    }
  }
  return true;
}

double FitList::cost(const FamilyFit& member, double noise) const {
  const Ends ends = member.reading.ends;
  const int numbers = member.fitted.parameters + numbers_of(ends, static_cast<int>(command_.legs.size()));
  return member.squares / (noise * noise) + numbers * std::log(static_cast<double>(window_.values())) +
         (ends == Ends::whole ? 0.0 : rare) + (member.reading.samples > 0 ? longest_first : 0.0);
}

LikelyFits FitList::likely(std::vector<FamilyFit> members, double noise) const {
  std::stable_sort(members.begin(), members.end(),
                   [&](const FamilyFit& a, const FamilyFit& b) { return cost(a, noise) < cost(b, noise); });
  const double most = cost(members.front(), noise) + options_.sigmas * options_.sigmas;
  LikelyFits result;
  std::vector<Filter> filters;
  std::vector<double> squares, costs;  // over that of the noise
  for (FamilyFit& member : members) {
    const Filter filter = make_filter(member.fitted.filter);
    std::size_t same = 0;
    while (same < filters.size() && !same_filter(result.fits[same], filters[same], member.fitted, filter)) ++same;
    if (same < filters.size()) {
      FittedFilter& fit = result.fits[same];
      const auto named = [&](const FittedFilter& other) { return same_name(other, member.fitted); };
      if (!named(fit) && std::ranges::none_of(fit.aliases, named)) fit.aliases.push_back(member.fitted);
      continue;
    }
    // A feed that no good fit has is not that of the log.
    if (cost(member, noise) > most) continue;
    const CommandFit fit = window_.fit(filter, member.reading.samples > 0 ? 1 : 2, member.reading);
    member.fitted.moves = moves_of(fit);
    if (!possible(member.fitted.moves)) continue;
    if (filters.empty()) result.first = fit;
    member.fitted.rms = window_.figure(filter, fit, member.fitted.parameters);
    filters.push_back(filter);
    squares.push_back(member.squares / (noise * noise)), costs.push_back(cost(member, noise));
    result.fits.push_back(member.fitted);
  }
  if (filters.empty())
    throw std::invalid_argument(
        fmt::format("no move at the given feed of {:.6g} mm/min explains the log; its constant speed is {:.6g} mm/min",
                    6e4 * options_.feed.value_or(0.0), 6e4 * command_.step / task_.sample_period));
  double sum = 0.0;
  for (const double c : costs) sum += std::exp(-0.5 * (c - costs.front()));
  for (std::size_t i = 0; i < squares.size(); ++i) {
    const double worse = squares[i] - squares.front();
    result.fits[i].sigmas = std::copysign(std::sqrt(std::abs(worse)), worse);
    result.fits[i].likelihood = std::exp(-0.5 * (costs[i] - costs.front())) / sum;
  }
  return result;
}

}  // namespace accdec
