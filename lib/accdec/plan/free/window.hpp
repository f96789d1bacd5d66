#pragma once

#include <cstddef>
#include <vector>

#include <accdec/plan/free/free_path.hpp>

namespace accdec {

/// A joint that a window passes between two of its samples.
struct WindowPass {
  std::size_t joint = 0;  ///< at the end of this block
  double at = 0.0;        ///< sample of the window, -1 .. size
  double room = 2.0;      ///< samples by which it may slide at most
};

/// Samples between fixed ones. The last samples before them stay; those after them are a mean of two shifted copies of
/// the old motion, which holds every limit on differences that both hold.
struct Window {
  std::size_t size = 0;              ///< samples, > 0
  std::vector<double> before;        ///< rows, `border` samples
  std::vector<double> guess;         ///< rows, `size` samples; becomes the answer
  std::vector<double> after, later;  ///< rows, `border` samples, of the two copies
  std::vector<std::size_t> leg;      ///< block of every sample, and of the first one after: size + 1
  std::size_t leg_before = 0;        ///< of the last sample before
  std::vector<WindowPass> passes;
  double slide = 0.0;  ///< part of their room by which passes may slide along the guess
};

/// Moves as far towards the later copy as the limits allow.
/// @param share  of the later copy, 0 .. 1: written
/// @param maximise  else any motion that holds the limits is an answer
/// @returns whether there is a motion
bool solve_window(const FreePath& free, Window& window, bool maximise, double& share);

}  // namespace accdec
