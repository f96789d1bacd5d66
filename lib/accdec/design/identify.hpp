#pragma once

#include <optional>
#include <string>
#include <vector>

#include <accdec/design/motion_log.hpp>
#include <accdec/task.hpp>

namespace accdec {

/// The command that was found in a log, straight moves at constant feeds from rest to rest.
struct LoggedMove {
  int first = 0, samples = 0;  ///< sample in which the command begins, and how many it moves
  double first_step = 1.0;     ///< part of the others that the first sample moves, less than 1 if it began in between
  double last_step = 1.0;      ///< part of the others that the last sample moves
  std::vector<double> way{};   ///< m, by axis
  /// m/s. @param period  s
  double feed(double period) const;
};

/// Samples that the second leg waits for the first; a short last step lasts one.
double delay_between(const LoggedMove& in, const LoggedMove& out);

/// A filter that a logged motion may have passed.
struct FittedFilter {
  SettingFamily family = SettingFamily::averages;
  FilterSpec filter{};
  int parameters = 1;       ///< numbers that were fitted: stages, 0 if there is no filter, 1 for a pole, taps ..
  double rms = 0.0;         ///< m, of the differences between log and fit in the samples in which the filter acts
  double sigmas = 0.0;      ///< by how many standard deviations of the noise the first fits better; < 0: this one does
  double likelihood = 0.0;  ///< a share among the fits listed, by the Bayesian criterion, 0 .. 1; 0 for taps
  double time_constant = 0.0;           ///< s, of a pole or a finite exponential
  double second_constant = 0.0;         ///< s, of a second pole in series; 0: there is none
  std::vector<LoggedMove> moves{};      ///< one, or both legs of a corner
  std::vector<FittedFilter> aliases{};  ///< the same filter by other names; only names and numbers
};

/// The answer to a log: the filters that its motion may have passed.
struct Identification {
  std::vector<FittedFilter> fits;  ///< those that fit; never empty. The first explains the log with the fewest numbers
  FittedFilter taps;               ///< any taps, as good as the log shows them
  double noise = 0.0;              ///< m, standard deviation, as given or found; mean of the axes that move, as below
  double log_noise = 0.0;          ///< m, as the log shows it at rest and at constant speed
  double rounding = 0.0;           ///< m, of the positions as they are written, part of both; 0: the log is exact
  std::vector<std::vector<double>> modelled;  ///< m, by axis and sample, of the first fit
};

/// Options of `identify`.
struct IdentifyOptions {
  std::optional<double> noise{};  ///< m, of every axis; none: that of the best fit, each axis by its own in the log
  double sigmas = 4.0;            ///< fits this much worse than the first, numbers included, are left out
  std::optional<double> feed{};   ///< m/s, of the first leg; none: any
};

/// Finds the filter behind a logged straight move or corner from rest to rest. The command is a run of whole samples at
/// one feed, or two with a rest between them. Its samples, feeds and place follow from the parts of the log at constant
/// speed; its length and place are fitted with every filter. The first and the last sample of a leg may move less than
/// the others, as where the log's samples lie between those of the control. A move of m samples behind an average of n
/// moves like one of n samples behind an average of m. Both are fits then, unless one is faster than `options` or the
/// task's largest velocities allow. All families of settings are looked at, whatever the task names. They are one to
/// three averages of every length, one or two endless poles, finite exponentials, Gaussians, windowed sincs, and up to
/// two averages with the impulses of a shaper. Impulses between samples are looked at if nothing else fits. Every
/// number that a family has more must explain more, or another fit stands first; which shaper it is counts as one.
/// Likelihoods count numbers in the same way, standard deviations do not. Members with the same taps are one fit.
/// Exponentials, Gaussians and sincs have 8 taps or more: shorter filters fit too many families. Taps are the answer if
/// they fit better than chance explains. They are also if the best family leaves far more than the noise, as the log
/// shows it at rest and at constant speed. Two poles that differ mostly end so. Positions that are all multiples of 1,
/// 2 or 5 times a power of ten are rounded: step / sqrt(12) is the least noise then, unless a family fits exactly. An
/// axis counts by its noise, as the log shows it; one that rests does not count. The task's `prefilter_taps` stand
/// behind every filter: what is found is the filter in front of them.
/// @param task  its sample period is that of the log; its largest order bounds the filters; without servos
/// @throws std::invalid_argument if the log does not begin and end at rest, if no part of a leg has a constant speed,
///         if it has too few samples for its filter, or if it moves faster than any machine
Identification identify(const MotionLog& log, const Task& task, const IdentifyOptions& options = {});

}  // namespace accdec
