#pragma once

#include <functional>
#include <string>

#include <accdec/certificate.hpp>

// Internal to the room: the check of proof::CornerFeeds.

namespace accdec {

/// Which corner feeds a proof is about.
inline constexpr const char* about_corner_feeds = "each corner feed lasts until the motion has settled";

/// Checks every part by `orders`, and computes the least that any ways past the corners cost with the orders left.
/// @param orders  throws Rejected unless the tree proves the lower bound of a result of the task
/// @throws Rejected
std::string check_corner_feeds(
    const proof::CornerFeeds& proof, const Task& task, const DesignResult& result,
    const std::function<void(const proof::BranchAndBound&, const Task&, const DesignResult&)>& orders);

}  // namespace accdec
