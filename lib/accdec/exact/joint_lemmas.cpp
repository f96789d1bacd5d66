#include <algorithm>
#include <limits>

#include <accdec/exact/joint_lemmas.hpp>
#include <accdec/machine/limits.hpp>

namespace accdec::exact {
namespace {

/// Whether a lemma implies another one.
bool says(const JointLemma& lemma, const JointLemma& other) {
  return lemma.from.empty() && lemma.order >= other.order &&
         std::all_of(lemma.delays.begin(), lemma.delays.end(), [&](const proof::CornerDelay& d) {
           return std::any_of(other.delays.begin(), other.delays.end(), [&](const proof::CornerDelay& its) {
             return its.corner == d.corner && its.delay <= d.delay;
           });
         });
}

}  // namespace

std::vector<int> JointLemma::most(std::size_t corners) const {
  std::vector<int> most(corners, -1);
  for (const auto& [j, delay] : delays) most[static_cast<std::size_t>(j)] = delay;
  return most;
}

int JointLemma::delay_at(int corner) const {
  return std::find_if(delays.begin(), delays.end(), [&](const auto& d) { return d.corner == corner; })->delay;
}

bool JointLemma::reaches(const JointNode& node) const {
  return std::equal(from.begin(), from.end(), node.d1.begin(), [](int least, int d) { return least <= d; });
}

JointLemmas::Judgement JointLemmas::judge(std::size_t lemma, const JointNode& node) const {
  int open = 0, corner = -1;
  double least = std::numeric_limits<double>::infinity(), most = -1.0;
  if (!lemmas_[lemma].reaches(node)) return {};
  for (const auto& [j, delay] : lemmas_[lemma].delays) {
    const auto i = static_cast<std::size_t>(j);
    if (node.d1[i] > delay) return {};
    // The largest delay that the target allows here.
    const double more = cost_.delay[i] * (delay + 1 - node.d1[i]);
    if (node.d2[i] <= delay) continue;
    ++open;
    least = std::min(least, more);
    if (more > most) most = more, corner = j;
  }
  return {open == 0 ? Verdict::closed : open == 1 ? Verdict::unit : Verdict::violated, corner, least};
}

void JointLemmas::add(JointLemma lemma) {
  lemmas_.push_back(std::move(lemma));
  fails_.push_back(std::numeric_limits<int>::max());
}

void JointLemmas::add_new(JointLemma lemma, std::size_t known) {
  if (std::none_of(lemmas_.begin() + static_cast<std::ptrdiff_t>(known), lemmas_.end(),
                   [&](const JointLemma& other) { return says(other, lemma); }))
    add(std::move(lemma));
}

void JointLemmas::extend(std::size_t lemma, JointLemma longer) {
  if (lemmas_[lemma].order < longer.order) lemmas_[lemma] = std::move(longer);
}

}  // namespace accdec::exact
