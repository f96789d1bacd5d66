#include <algorithm>
#include <deque>
#include <span>
#include <utility>
#include <vector>

#include <accdec/simulate.hpp>
#include <accdec/simulate/command_stream.hpp>
#include <accdec/simulate/motion_buffer.hpp>
#include <accdec/simulate/profile_motion.hpp>
#include <accdec/simulate/simulate.hpp>

namespace accdec {

/// A kind of plan, sample by sample. `next` gives one sample, false after the last. `blocks` says where that may be.
/// `pass_steady` passes over samples that change nothing: at rest or at constant velocity.
class Motion::Source {
 public:
  Source() = default;
  virtual ~Source() = default;
  Source(const Source&) = delete;
  Source& operator=(const Source&) = delete;
  virtual bool next(Sample& sample) = 0;
  virtual std::pair<std::size_t, std::size_t> blocks() const = 0;
  virtual void pass_steady() = 0;
};

namespace {

/// Samples of a command in which it moves first by u0, then by u.
struct Stretch {
  AxisRow<0> u0{}, u{}, end{};
  std::int64_t count = 0;
};

/// The first and the last sample in which a filtered command may be at a joint.
struct JointSamples {
  std::int64_t first, last;
};

/// The commands of one run, from emit_commands.
struct RunSink {
  std::vector<Stretch>& stretches;
  std::deque<JointSamples>& joints;
  std::int64_t begin, longer;  // the run's first sample; samples by which the filter is behind
  void command(const AxisRow<0>& u0, const AxisRow<0>& u, std::int64_t count, const AxisRow<0>& end) const {
    stretches.push_back({u0, u, end, count});
  }
  void joint(std::size_t /*block*/, double time, std::int64_t rest) const {
    const std::int64_t first = begin + static_cast<std::int64_t>(time);
    joints.push_back({first, first + rest + longer});
  }
};

/// One block more on either side: the samples of a trajectory round off its corners.
std::pair<std::size_t, std::size_t> with_neighbours(std::size_t first, std::size_t last) {
  return {first > 0 ? first - 1 : 0, last + 1};
}

}  // namespace

/// The commands of a path and its delays, convolved with the filter a buffer at a time.
class Motion::FilteredSource : public Source {
 public:
  FilteredSource(const Toolpath& path, const FilteredCommand& command, std::span<const Filter> filters, double period)
      : path_(path),
        n_(path.dimensions()),
        period_(period),
        timing_(path, period, command.delays),
        buffer_(filters, n_, path.point(0)),
        longest_(*std::ranges::max_element(filters, {}, &Filter::order)),
        last_(motion_samples(timing_, longest_)),
        begin_(timing_.dwell_samples(path.dwell_first)) {
    std::copy_n(path.point(0), n_, at_.begin());
    rest(begin_);
  }

  bool next(Sample& sample) override {
    if (number_ > last_) return false;
    sample.number = number_;
    if (number_ == 0) {
      std::copy_n(path_.point(0), n_, sample.position.begin());
      sample.velocity.fill(0.0);
    } else {
      if (number_ > buffer_.sample()) fill();
      const auto since_seen = number_ - buffer_.number(buffer_.seen_begin());
      for (std::size_t a = 0; a < n_; ++a) {
        sample.position[a] = buffer_.positions(a)[number_];
        sample.velocity[a] = buffer_.velocity(a)[since_seen] / period_;
      }
    }
    ++number_;
    return true;
  }

  std::pair<std::size_t, std::size_t> blocks() const override {
    const std::int64_t now = number_ - 1;
    const auto left = std::ranges::partition_point(joints_, [&](const JointSamples& j) { return j.last < now; });
    const auto reached = std::ranges::partition_point(joints_, [&](const JointSamples& j) { return j.first < now; });
    return {left_ + static_cast<std::size_t>(left - joints_.begin()),
            left_ + static_cast<std::size_t>(reached - joints_.begin())};
  }

  void pass_steady() override {
    if (number_ != buffer_.sample() + 1 || next_ >= stretches_.size() || buffer_.settled() > buffer_.sample()) return;
    Stretch& stretch = stretches_[next_];
    const bool steady = stretch.u0 == moving_ && stretch.u == moving_;
    const std::int64_t passed = std::min(stretch.count, last_ - number_) - 1;
    if (!steady || passed <= 0) return;
    stretch.count -= passed;
    buffer_.pass_over(passed, stretch.u.data(), stretch.end.data(), stretch.count);
    number_ += passed;
  }

 private:
  /// Makes the next samples; after the last command it rests.
  void fill() {
    buffer_.seen();
    if (buffer_.room() == 0) buffer_.shift(at_.data());
    while (buffer_.room() > 0) {
      if (next_ == stretches_.size()) command_run();
      Stretch& stretch = stretches_[next_];
      const std::int64_t count = std::min(stretch.count, buffer_.room());
      buffer_.append<0>(stretch.u0, stretch.u, count);
      stretch.count -= count;
      stretch.u0 = moving_ = stretch.u;
      for (std::size_t a = 0; a < n_; ++a) at_[a] = stretch.end[a] - static_cast<double>(stretch.count) * stretch.u[a];
      if (stretch.count == 0) ++next_;
    }
    buffer_.make();
  }

  void rest(std::int64_t count) {
    if (count > 0) stretches_.push_back({{}, {}, at_end_of(stretches_), count});
  }
  AxisRow<0> at_end_of(const std::vector<Stretch>& stretches) const {
    return stretches.empty() ? at_ : stretches.back().end;
  }

  /// The commands of the next run and the rest after it.
  void command_run() {
    stretches_.clear();
    next_ = 0;
    if (run_ == path_.blocks()) return rest(std::max<std::int64_t>(1, buffer_.room()));
    for (; !joints_.empty() && joints_.front().last < number_ - 1; joints_.pop_front()) ++left_;
    const std::size_t end = timing_.run_end(run_);
    RunSink sink{stretches_, joints_, begin_, longest_.order() + 2};
    emit_commands<0>(timing_, run_, end, sink);
    const std::int64_t count = CommandTiming::run_samples(timing_.run_length(run_, end));
    std::int64_t pause = end + 1 < path_.blocks() ? timing_.delay(end) : 0;
    for (; dwell_ < path_.dwell.size() && path_.dwell[dwell_].first <= end; ++dwell_)
      pause += timing_.dwell_samples(path_.dwell[dwell_].second);
    rest(pause);
    if (end + 1 < path_.blocks()) sink.joint(end, static_cast<double>(count), pause);
    begin_ += count + pause;
    run_ = end + 1;
  }

  const Toolpath& path_;
  const std::size_t n_;
  const double period_;
  const CommandTiming timing_;
  MotionBuffer buffer_;
  const Filter& longest_;
  const std::int64_t last_;
  std::int64_t begin_;       // of the next run
  std::int64_t number_ = 0;  // of the next sample
  AxisRow<0> at_{};          // where the command has come to
  AxisRow<0> moving_{};      // by what the command moved last
  std::vector<Stretch> stretches_;
  std::size_t next_ = 0, run_ = 0, dwell_ = 0;
  std::deque<JointSamples> joints_;  // of the run and what the filter sees before it
  std::size_t left_ = 0;             // joints before these
};

/// The ramps and corners of plan `profiles`, behind its last filter.
class Motion::TrajectorySource : public Source {
 public:
  TrajectorySource(const Toolpath& path, const Trajectory& trajectory, double period)
      : n_(path.dimensions()), period_(period), motion_(path, trajectory.chain, period, trajectory.last) {
    std::copy_n(path.point(0), n_, before_.begin());
  }

  bool next(Sample& sample) override {
    if (rested_) return false;
    sample.number = number_;
    sample.position = before_;
    sample.velocity.fill(0.0);
    if (number_++ == 0) return true;
    rested_ = !motion_.next();
    for (std::size_t a = 0; a < n_ && !rested_; ++a) {
      sample.position[a] = motion_.position()[a];
      sample.velocity[a] = (sample.position[a] - before_[a]) / period_;
    }
    before_ = sample.position;
    return true;
  }
  std::pair<std::size_t, std::size_t> blocks() const override {
    return with_neighbours(static_cast<std::size_t>(motion_.place_first() / 2),
                           static_cast<std::size_t>(motion_.place_last() / 2));
  }
  void pass_steady() override {
    const std::int64_t passed = motion_.pass_steady();
    if (passed == 0) return;
    number_ += passed;
    std::copy_n(motion_.position(), n_, before_.begin());
  }

 private:
  const std::size_t n_;
  const double period_;
  ProfileMotion motion_;
  std::array<double, program_axis_count> before_{};
  std::int64_t number_ = 0;
  bool rested_ = false;
};

/// The positions of plan `free` as they are recorded.
class Motion::SampledSource : public Source {
 public:
  SampledSource(const Toolpath& path, const FreeMotion& motion, double period)
      : n_(path.dimensions()), period_(period), motion_(motion) {
    std::copy_n(path.point(0), n_, before_.begin());
  }

  bool next(Sample& sample) override {
    const auto count = static_cast<std::int64_t>(motion_.block.size());
    if (number_ > count + 1) return false;
    sample.number = number_;
    sample.position = before_;
    sample.velocity.fill(0.0);
    if (number_ > 0 && number_ <= count) {
      std::copy_n(motion_.position.data() + static_cast<std::size_t>(number_ - 1) * n_, n_, sample.position.begin());
      for (std::size_t a = 0; a < n_; ++a) sample.velocity[a] = (sample.position[a] - before_[a]) / period_;
    }
    before_ = sample.position;
    ++number_;
    return true;
  }
  std::pair<std::size_t, std::size_t> blocks() const override {
    const auto count = static_cast<std::int64_t>(motion_.block.size());
    const std::int64_t sample = std::clamp<std::int64_t>(number_ - 1, 1, count);
    const std::size_t block = motion_.block[static_cast<std::size_t>(sample - 1)];
    return with_neighbours(block, block);
  }
  void pass_steady() override {}

 private:
  const std::size_t n_;
  const double period_;
  const FreeMotion& motion_;
  std::array<double, program_axis_count> before_{};
  std::int64_t number_ = 0;
};

Motion::Motion(const Plan& plan, double sample_period, bool servo) {
  if (const FilteredCommand* command = plan.command()) {
    source_ = std::make_unique<FilteredSource>(
        plan.path, *command, servo ? command->motion() : std::span(&command->filter, 1), sample_period);
  } else if (plan.trajectory()->is_free()) {
    source_ = std::make_unique<SampledSource>(plan.path, plan.trajectory()->free, sample_period);
  } else {
    source_ = std::make_unique<TrajectorySource>(plan.path, *plan.trajectory(), sample_period);
  }
}

Motion::~Motion() = default;

bool Motion::next(Sample& sample) {
  return source_->next(sample);
}
std::pair<std::size_t, std::size_t> Motion::blocks() const {
  return source_->blocks();
}
void Motion::pass_steady() {
  source_->pass_steady();
}

}  // namespace accdec
