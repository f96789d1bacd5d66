#pragma once

#include <vector>

#include <accdec/program/plan/feed_march.hpp>
#include <accdec/program/read/toolpath.hpp>

namespace accdec {

/// The path with a block for every piece: blocks are split where their feeds change, by straight joints that need no
/// tolerance. The last piece of a block ends in its joint; dwells, delays that were given and words passed on keep
/// their places.
/// @param pieces  that cover the path in the order of its blocks; their rests are not looked at
Toolpath split_blocks(const Toolpath& path, const std::vector<FeedPiece>& pieces);

}  // namespace accdec
