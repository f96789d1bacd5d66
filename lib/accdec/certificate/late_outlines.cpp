#include <algorithm>
#include <cmath>
#include <limits>

#include <accdec/certificate/late_outlines.hpp>

namespace accdec {
namespace {

constexpr double never = std::numeric_limits<double>::infinity();

}  // namespace

LateOutlines::Place LateOutlines::place_of(const AveragesOutline& outline) {
  Place place{{outline.lengths.begin(), outline.lengths.end()}};
  double weight = 0.0, moment = 0.0;
  for (const auto& [at, w] : outline.impulses) weight += w, moment += w * static_cast<double>(at);
  double middle = 2.0 * moment / weight;
  for (const int length : outline.lengths) middle += length - 1;
  if (outline.impulses.size() > 1) {
    place.last = 2.0 * moment / weight;
  } else {
    place.last = place.before.back();
    place.before.pop_back();
  }
  const double whole = std::round(middle);
  if (std::abs(middle - whole) < 1e-9) place.parity = static_cast<std::size_t>(std::fmod(whole, 2.0));
  return place;
}

/// Members late with shorter averages are late here.
void LateOutlines::enter(const std::vector<int>& before) {
  const std::size_t size = before.size(), at = size > 0 ? static_cast<std::size_t>(before.back()) : 0;
  const bool same_stages = asked_.before.size() == size && here_ != nullptr;
  bool shorter = !same_stages;
  for (std::size_t s = 0; same_stages && s + 1 < size; ++s) shorter = shorter || before[s] < asked_.before[s];
  if (shorter) from_.clear();
  if (from_.size() <= at) from_.resize(at + 1, {never, never, never});
  const std::size_t last = same_stages && !shorter && size > 0 ? static_cast<std::size_t>(asked_.before.back()) : at;
  here_ = &from_[at];
  if (last >= at) return;
  for (std::size_t c = 0; c < classes; ++c) (*here_)[c] = std::min((*here_)[c], from_[last][c]);
}

bool LateOutlines::covers(const AveragesOutline& outline) {
  Place place = place_of(outline);
  if (here_ == nullptr || place.before != asked_.before) enter(place.before);
  asked_ = std::move(place);
  return asked_.last >= std::min((*here_)[asked_.parity], (*here_)[2]);
}

bool LateOutlines::asks_between() const {
  return asked_.last < (*here_)[2];
}

void LateOutlines::remember(bool between) {
  double& whole = (*here_)[asked_.parity];
  if (asked_.parity < 2) whole = std::min(whole, asked_.last);
  if (between) (*here_)[2] = std::min((*here_)[2], asked_.last);
}

}  // namespace accdec
