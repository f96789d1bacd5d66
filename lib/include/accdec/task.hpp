// Tasks: what to design within which limits, and the reader of task files.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <accdec/corner.hpp>
#include <accdec/files.hpp>
#include <accdec/filter.hpp>
#include <accdec/machine.hpp>

// The settings that a controller offers its user, and those that a design chose.

namespace accdec {

/// Families of filters that parameters of a controller choose from.
enum class SettingFamily {
  taps,      ///< any taps
  averages,  ///< moving averages in series
  one_pole,  ///< endless exponentials in series, cut off where 1e-4 of their step is left
  shaper,    ///< moving averages in series, with impulses behind them
  // A length and one real number on a grid:
  exponential,   ///< a finite exponential: length and time constant
  gaussian,      ///< length and alpha
  windowed_sinc  ///< Blackman's window times a sinc: length and cut-off frequency
};
struct SettingFamilyName {
  SettingFamily family;
  std::string_view name;  ///< in task files
};
inline constexpr std::array<SettingFamilyName, 7> setting_families{{{SettingFamily::taps, "taps"},
                                                                    {SettingFamily::averages, "averages"},
                                                                    {SettingFamily::one_pole, "one-pole"},
                                                                    {SettingFamily::shaper, "shaper"},
                                                                    {SettingFamily::exponential, "exponential"},
                                                                    {SettingFamily::gaussian, "gaussian"},
                                                                    {SettingFamily::windowed_sinc, "windowed-sinc"}}};
std::string_view to_string(SettingFamily family);
std::optional<SettingFamily> setting_family_from_string(std::string_view name);

/// How a controller delays the second leg of a corner.
enum class DelayKind {
  continuous,   ///< d = 0: the next block starts as the command of the last ends
  exact_stop,   ///< d at which filter and smoothing are empty, N + P, or one more where a limit asks for it
  in_position,  ///< d = L + min{e >= 0: v1 T p(e) <= w}, with one width w for all corners; L, see ControllerSettings.
                ///< By axis: v1 is that of the fastest axis of leg 1
  dwell,        ///< any d, by a dwell before the filter
  timed_axis,   ///< any d, by a timed move of an unused axis
  corner_feed   ///< d = 0 at a part of both feeds, at which the motion has settled
};
struct DelayKindName {
  DelayKind kind;
  std::string_view name;  ///< in task files
};
inline constexpr std::array<DelayKindName, 6> delay_kinds{{{DelayKind::continuous, "continuous"},
                                                           {DelayKind::exact_stop, "exact-stop"},
                                                           {DelayKind::in_position, "in-position"},
                                                           {DelayKind::dwell, "dwell"},
                                                           {DelayKind::timed_axis, "timed-axis"},
                                                           {DelayKind::corner_feed, "corner-feed"}}};
std::string_view to_string(DelayKind kind);
std::optional<DelayKind> delay_kind_from_string(std::string_view name);

/// One time that a controller takes: the length of a moving average, or the time constant of a pole.
struct SettableStage {
  std::string name{};                ///< of the parameter, as the controller prints it: "MD32410"; may be empty
  std::string unit = "ms";           ///< in which it is entered, as it is printed
  double unit_seconds = 1e-3;        ///< s in one unit
  double length_step = 0.0;          ///< s, a multiple of the sample period; 0: the sample period
  double length_max = 0.0;           ///< s; 0: no cap
  std::vector<double> length_set{};  ///< s, multiples of the sample period, rising; empty: every multiple of the step
};

/// How programs of a control are written, beside the words of its kinds of delays.
struct ControlDialect {
  std::string metric{};       ///< for lengths in mm and feeds in mm/min; empty: none is needed
  std::string dwell{};        ///< before its seconds, a block of its own: "G4 F"; empty: not known
  std::string comment{};      ///< before a remark
  std::string comment_end{};  ///< behind it; empty: the line's end
};

/// The choices that a controller leaves to its user. A stage may always be off.
struct ControllerSettings {
  std::vector<SettingFamily> families{SettingFamily::taps};  ///< at least one; the best of all is designed
  std::vector<SettableStage> stages{};                       ///< 1 to 3 unless all that is designed are taps
  const ShaperInfo* shaper = nullptr;                        ///< SettingFamily::shaper: which of shaper_list()
  /// Steps of real numbers, whose members are multiples. The length of these families is the first stage's.
  double time_constant_step = 0.0;  ///< SettingFamily::exponential, s; 0: the sample period
  double alpha_step = 0.1;          ///< SettingFamily::gaussian; alpha is at most 6
  double cutoff_step = 1.0;         ///< SettingFamily::windowed_sinc, Hz; at most 1 / (N T)
  /// SettingFamily::shaper of a control that interpolates, Hz: its frequencies are multiples, its impulses at any time
  /// from one sample on. 0: impulses at whole samples.
  double shaper_frequency_step = 0.0;
  std::vector<DelayKind> delays{};   ///< empty: any number of samples
  bool in_position_actual = false;   ///< the remaining way is that of the motion behind the servo, not of the command
  bool in_position_by_axis = false;  ///< every axis must be within the width, not the way along the path
  double in_position_latency = 0.0;  ///< s, a multiple of the period: from within the width until the next block starts
  double corner_feed_step = 0.05;    ///< DelayKind::corner_feed: the parts of the feed are multiples of it, below 1
  std::string controller{};          ///< its title, for people; may be empty
  std::vector<std::string> assumed{};               ///< what no source says of it and its settings rely on, for people
  std::vector<std::string> delay_words{};           ///< of its programs, one for each of `delays`; empty: not known
  std::shared_ptr<const ControlDialect> dialect{};  ///< of its programs, as its file has it; null: not known
  bool from_file = false;                           ///< a controller was named, built in or by a file

  bool names(SettingFamily family) const;
  bool names(DelayKind kind) const;
  /// Whether anything but free taps is designed.
  bool names_family() const;
  /// Whether any number of samples can be had.
  bool any_delay() const;
  /// Whether a task may give a corner so many samples: any, or for free taps what their one kind of delay gives.
  bool may_be_given(int delay) const;
  /// The word of a kind; empty if it is not known.
  std::string_view word_of(DelayKind kind) const;
};

/// The speed, m/s, of the way that a control compares with its in-position width: along leg 1, or of its fastest axis.
double watched_speed(const ControllerSettings& settings, const Corner& corner);

/// The delays that a control has for the corners of a program.
struct ControlDelays {
  std::vector<DelayKind> kinds{};  ///< empty: delays of any number of samples
  double width = 0.0;              ///< m, of all corners that are in-position; 0: none is
  bool by_axis = false;            ///< see ControllerSettings::in_position_by_axis
  int latency = 0;                 ///< samples from within the width to the next block's start

  bool names(DelayKind kind) const;
  /// Whether any number of samples can be had.
  bool any() const { return kinds.empty() || names(DelayKind::dwell) || names(DelayKind::timed_axis); }
};

/// One number to enter.
struct Setting {
  std::string name;  ///< of the parameter
  double value = 0.0;
  std::string unit;
};

/// The in-position widths that give the same delays at all corners: low <= w < high.
struct WidthInterval {
  double low = 0.0, high = 0.0;  ///< m; high may be infinite
  /// The width to enter: the middle, or twice the least if any larger one will do.
  double middle() const;
};

/// A design in the words of a controller.
struct ChosenSettings {
  SettingFamily family = SettingFamily::taps;
  FilterSpec filter{};
  std::vector<Setting> values{};
  std::vector<DelayKind> delays{};       ///< the kind at each corner; empty: any number of samples
  std::optional<WidthInterval> width{};  ///< where some corner is in-position
};

/// The time that a design makes least, in sample periods. For one corner of weight 1 in one run both are N + 1 + d.
enum class Objective {
  cycle,  ///< machine time: runs (N + 1) + sum_j w_j d_j; a run from rest to rest takes the filter's time once
  corner  ///< sum_j w_j (N + 1 + d_j): every corner as a run of its own
};

/// Bounds on the choices of a design, and its objective.
struct DesignBounds {
  int order_min = 1;
  int order_max = 400;
  bool symmetric = false;
  Objective objective = Objective::cycle;
  int coefficient_bits = 0;  ///< taps are multiples of 2^-bits; 0: any
  double runs = 1.0;  ///< > 0; number of runs from rest to rest; together they pass every corner as often as its weight
                      ///< says
};

/// Legs in the plane of the first two axes.
struct PlanarLegs {
  double angle = 0.0;    ///< rad, interior, 0 < angle <= pi
  double heading = 0.0;  ///< rad, travel direction on leg 1 from +x towards +y
  Turn turn = Turn::left;
};
/// Legs along any directions: vectors of any positive length, one number per axis.
struct DirectedLegs {
  std::vector<double> in, out;
};
/// The legs of a corner as given, so that a result can state them.
using CornerLegs = std::variant<PlanarLegs, DirectedLegs>;

/// One corner of a task. Its geometry follows from legs and feeds and cannot disagree with them.
class TaskCorner {
 public:
  /// @param feed_in, feed_out  m/s, > 0
  /// @param axes  of the machine, for planar legs; other legs define their own number
  /// @throws std::invalid_argument on values outside these ranges
  TaskCorner(std::string name, CornerLegs legs, double feed_in, double feed_out, int axes = 2);

  std::string name;
  std::optional<double> error_max;  ///< m; none: no bound
  double speed_min = 0.0;           ///< m/s, bound on the smallest tangential speed
  /// m, bound on the largest distance of the polyline through the samples from the two programmed legs; none: no bound
  std::optional<double> contour_max;
  std::optional<int> delay;  ///< samples; none: to be chosen
  double weight = 1.0;       ///< > 0, of this corner in the cycle time

  const CornerLegs& legs() const { return legs_; }
  const Corner& geometry() const { return geometry_; }
  /// @throws std::invalid_argument unless both are positive and finite, m/s
  void set_feeds(double feed_in, double feed_out);

 private:
  CornerLegs legs_;
  Corner geometry_;
};

/// A design task: what accdec reads from a task file. SI throughout.
struct Task {
  std::string title;
  double sample_period = 1e-3;         ///< s
  std::optional<FilterSpec> filter;    ///< none: to be designed
  std::optional<FilterSpec> baseline;  ///< [baseline]: the filter the machine has today, to compare designs with
  DesignBounds design;
  std::optional<ControllerSettings> settings;  ///< what a controller lets its user set; none: any taps and delays
  Machine machine;
  std::vector<TaskCorner> corners;
  std::optional<double> program_error_max;    ///< m, [program] error_max_um
  std::optional<double> program_contour_max;  ///< m, [program] contour_max_um
  std::vector<std::string> notes{};           ///< keys that were read but are better written in another way
};

/// Parts of the machine that a caller considers beside the limits of its axes: none, or the control's own smoothing.
/// Comparisons (`loads`) also know servos, dry friction, force-speed curves, the supply and modes of axes. `all` adds
/// the time that a control takes to begin a block (in_position_latency_ms).
enum class Considered { none, smoothing, loads, all };

/// Requirements of the caller on a task.
struct TaskOptions {
  bool require_corners = true;   ///< false for tasks of whole programs
  bool require_choices = false;  ///< the filter and every corner's delay must be given: nothing is left to design
  /// Number of axes that a single [[axis]] table, or none, stands for if no corner gives their number: 1 .. 9. They are
  /// named x, y, z, a, b, c, u, v, w in order.
  int axes = 2;
  /// Keys of what the caller does not consider are refused where they stand, so that none is ignored silently.
  Considered response = Considered::none;
  /// Whether [controller] may name a file, which is then opened; not where the text comes from somebody else.
  bool controller_files = true;
};

/// Reads a task file (TOML, see README). It is strict, because a misspelt limit that is silently ignored could damage a
/// machine. Unknown keys, wrong types, values outside their range, contradictions within the file and numbers that are
/// not finite are errors.
///
/// One [[axis]] table applies to every axis; none means axes x, y without limits. A corner is given in one of two ways.
/// One is angle_deg, heading_deg and turn, in the plane of the first two axes. The other is direction_in and
/// direction_out, with one number per axis (1 to 9 axes).
/// @throws InputError at the position of the first error.
Task read_task(const std::string& path, const TaskOptions& options = {});
/// The same for text; `name` stands for the file in messages.
Task parse_task(std::string_view text, const std::string& name, const TaskOptions& options = {});

/// A task as a task file, with every axis written out. Reading it gives exactly the same task: numbers are chosen so
/// that their conversion to SI gives the same value.
std::string task_to_toml(const Task& task);

}  // namespace accdec
