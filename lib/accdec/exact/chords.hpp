#pragma once

#include <optional>
#include <vector>

#include <accdec/exact/rows.hpp>

namespace accdec::exact {

/// A limit outside the convex class, at all its samples. It is power at the start or of a blend, regeneration at the
/// stop or of a blend, or the smallest speed of a blend.
struct ChordFamily {
  enum Kind { power, regeneration, speed } kind = power;
  std::optional<int> corner;  ///< none: start or stop
  int axis = 0;               ///< power, regeneration
  int sign = 1;               ///< power, regeneration: direction of travel
  bool operator==(const ChordFamily&) const = default;
};
/// Such a limit at one sample, replaced by its chord over low .. high: m/s, or rad from leg 1's direction (speed).
struct Chord {
  ChordFamily family;
  int sample = 0;
  double low = 0.0, high = 0.0;
};
proof::Row row_of(const Chord& chord);
/// The chord of a row; none if the row is no chord.
std::optional<Chord> chord_of(const proof::Row& row);

/// The limits outside the convex class as chords over a box's tube.
///
/// Power F V <= P bounds the force by the hyperbola P/V. Over V in [l, u], the region below the hyperbola has the
/// region below its chord as convex hull: F <= P (1/l + 1/u - V/(l u)). A chord from l = P/F_max on also holds for all
/// smaller speeds, by the force limit. Regeneration is the same with the force's sign turned. The smallest speed cuts
/// off a sector of directions by the chord of its circle. F and V are linear in the cumulative responses.
///
/// All of these are of the motion: behind a response, responses, tubes and filters here are those of the motion.
class Chords {
 public:
  /// Keeps the references.
  Chords(const Task& task, const ConvexRows& rows);

  const std::vector<ChordFamily>& families() const { return families_; }
  /// Last sample of a family at which its limit can matter.
  int last_sample(const ChordFamily& family, const Box& box) const;
  /// Whether such a limit can be used in the box: limits of the blend, except the smallest speed, need a single delay.
  bool single_delay(const ChordFamily& family, const Box& box) const;
  /// Use of a limit at a sample, value/bound (bound/value for the smallest speed).
  double use(const ChordFamily& family, int sample, const Filter& motion, const Box& box) const;

  /// The chord over the box's tube. None if the limit holds throughout or no chord is possible.
  std::optional<Chord> draw(const ChordFamily& family, int sample, const Box& box) const;
  /// Whether the chord covers all speeds (or directions) that the box's tube leaves.
  bool covers(const Chord& chord, const Box& box) const;
  SparseRow row(const Chord& chord, const Box& box) const;
  /// Chords over the box's tube that the designed filter breaks by more than `slack`.
  std::vector<Chord> broken(const Filter& filter, const Box& box, double slack) const;

  /// The chord shrunk to the filter's own speed: a filter that holds it also holds the limit. None where the limit is
  /// far.
  /// @param least_use  of the limit, where it still counts as near
  std::optional<Chord> tangent(const Chord& at, const Filter& motion, const Box& box, double least_use) const;
  /// Adds the limits that the designed filter comes close to or breaks; returns the worst use.
  double gather_close(const Filter& filter, const Box& box, std::vector<Chord>& close) const;

 private:
  struct Range {
    double low, high;
  };
  void find_families();
  void add_family(const ChordFamily& family);
  const Axis& axis(const ChordFamily& family) const;
  double cosine(const ChordFamily& family) const;
  double turn(const ChordFamily& family) const;
  Legs event_legs(const ChordFamily& family) const;
  int event_delay(const ChordFamily& family, const Box& box) const;
  double bound(const ChordFamily& family) const;
  double force_cap(const ChordFamily& family) const;
  Range speed_range(const ChordFamily& family, int sample, const Box& box) const;
  Range direction_range(const ChordFamily& family, int sample, const Box& box) const;
  SparseRow speed_row(const Chord& chord, const Box& box) const;
  /// Order of the box's filters, as motions.
  int order(const Box& box) const { return box.order + rows_.motion().order(); }

  const Task& task_;
  const ConvexRows& rows_;
  std::vector<EventSpeeds> speeds_;
  std::vector<ChordFamily> families_;
};

}  // namespace accdec::exact
