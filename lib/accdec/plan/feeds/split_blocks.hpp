#pragma once

#include <vector>

#include <accdec/plan/feeds/feed_march.hpp>
#include <accdec/simulate.hpp>

namespace accdec {

/// The path with a block for every piece. Blocks are split where their feeds change, by straight joints that need no
/// tolerance. The last piece of a block ends in its joint. Dwells, given delays and words passed on keep their places.
/// @param pieces  that cover the path in the order of its blocks; their rests are ignored
Toolpath split_blocks(const Toolpath& path, const std::vector<FeedPiece>& pieces);

}  // namespace accdec
