#include <cmath>

#include <fmt/format.h>

#include <accdec/certificate.hpp>
#include <accdec/certificate/checked_tree.hpp>
#include <accdec/certificate/constant_feed.hpp>
#include <accdec/certificate/corner_feed_check.hpp>
#include <accdec/certificate/corner_speed_check.hpp>
#include <accdec/certificate/family_check.hpp>
#include <accdec/certificate/merged_corners.hpp>
#include <accdec/certificate/proof_claim.hpp>
#include <accdec/task/objective.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

std::string check(const proof::ConstantFeed&, const Task& task, const DesignResult& result,
                  const std::function<bool()>&) {
  if (result.status != Status::infeasible) throw Rejected("the certificate is one of infeasibility, the status is not");
  std::string broken = broken_at_constant_feed(task);
  if (broken.empty()) throw Rejected("no limit is broken at constant feed");
  return broken;
}

std::string check(const proof::CornerSpeed&, const Task& task, const DesignResult& result,
                  const std::function<bool()>&) {
  if (result.status != Status::infeasible) throw Rejected("the certificate is one of infeasibility, the status is not");
  std::string impossible = too_fast_for_its_error(task);
  if (impossible.empty()) throw Rejected("no smallest speed is surely too much within its corner's error");
  return impossible;
}

std::string check(const proof::Enumeration&, const Task&, const DesignResult&, const std::function<bool()>&) {
  throw Rejected("the certificate is about the delays of a given filter, the task leaves the filter open");
}

std::string check(const proof::BranchAndBound& proof, const Task& task, const DesignResult& result,
                  const std::function<bool()>& stop) {
  const double target = claimed_samples(task, result, proof);
  // Values that the verification accepts must be refuted too.
  const Task whole = proof.smoothed ? with_smoothing(task) : task;
  const Task merged = granted_limits(merged_corners(whole, proof.corner_of));
  const double longer = cost_of(task).filter * (whole.design.order_max - task.design.order_max);
  const std::size_t leaves = check_tree(merged, proof, {.target = target + longer}, stop);
  if (std::isinf(target)) return fmt::format("{} parts refuted: nothing holds all limits", leaves);
  return fmt::format("{} parts refuted: no {} time is shorter than {:.9g} s, within the tolerance of the verification",
                     leaves, to_string(task.design.objective), target * task.sample_period);
}

std::string check(const proof::CornerFeeds& proof, const Task& task, const DesignResult& result,
                  const std::function<bool()>& stop) {
  return check_corner_feeds(proof, task, result,
                            [&](const proof::BranchAndBound& orders, const Task& at, const DesignResult& bound) {
                              check(orders, at, bound, stop);
                            });
}

std::string check(const proof::FamilyEnumeration& proof, const Task& task, const DesignResult& result,
                  const std::function<bool()>& stop) {
  std::string members = check_families(proof, task, result, stop);
  if (!result.lower_bound) return members;
  if (!proof.taps) throw Rejected("the certificate has no bound of free taps");
  DesignResult taps;
  taps.lower_bound = result.lower_bound, taps.status = Status::feasible;
  Task any = task;
  any.settings.reset();
  return fmt::format("{}; free taps: {}", members, check(*proof.taps, any, taps, stop));
}

}  // namespace

std::shared_ptr<const Certificate> certify_contradiction(const Task& task) {
  if (broken_at_constant_feed(task).empty()) return std::make_shared<Certificate>(Certificate{proof::CornerSpeed{}});
  return std::make_shared<Certificate>(Certificate{proof::ConstantFeed{}});
}

CheckReport check_certificate(const Task& task, const DesignResult& result, const std::function<bool()>& stop) {
  if (!result.certificate) return {false, "there is no certificate"};
  try {
    return {true,
            std::visit([&](const auto& proof) { return check(proof, task, result, stop); }, result.certificate->proof)};
  } catch (const Rejected& e) {
    return {false, e.what()};
  }
}

}  // namespace accdec
