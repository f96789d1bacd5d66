#pragma once

#include <accdec/gcode/arc.hpp>

namespace accdec {

/// The arc under way and the one before it.
class ArcSequence {
 public:
  void begin(const Arc& arc, int chords);
  /// Counts a move. @return whether it is a chord of the arc
  bool take() {
    const bool of_arc = chords_ > 0;
    chords_ -= of_arc ? 1 : 0;
    return of_arc;
  }
  void moved(bool of_arc) {
    after_arc_ = of_arc;
    goes_on_ = false;
  }
  /// The arc that begins with the next move goes on along the circle of the last one.
  bool goes_on() const { return goes_on_; }
  const Arc& arc() const { return arc_; }
  /// m, of its chords from it at most.
  double distance() const { return distance_; }

 private:
  Arc arc_;
  int chords_ = 0;  // of the arc that are still to come
  double distance_ = 0.0;
  bool after_arc_ = false, goes_on_ = false;
};

}  // namespace accdec
