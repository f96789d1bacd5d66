#include <cmath>
#include <iterator>

#include <nlohmann/json.hpp>

#include <accdec/plan/report/samples.hpp>
#include <accdec/program.hpp>
#include <accdec/simulate.hpp>

namespace accdec {

namespace {

std::int64_t in_units(double position, double unit) {
  return std::llround(position / unit);
}

}  // namespace

SampleTable::SampleTable(const Toolpath& path, double sample_period, std::ostream& out, bool servo, double unit)
    : path_(path), period_(sample_period), unit_(unit), out_(out) {
  fmt::format_to(std::back_inserter(text_), "time_s");
  for (const char* of : {"", "_motion"}) {
    for (std::size_t a = 0; a < path.dimensions() && (*of == '\0' || servo); ++a) {
      const std::string name = rotary_axis(path.axes[a]) ? "deg" : "mm";
      if (unit > 0.0)
        fmt::format_to(std::back_inserter(text_), ",{}{}_units", path.axis_name(a), of);
      else
        fmt::format_to(std::back_inserter(text_), ",{0}{1}_{2},{0}{1}_{2}_s", path.axis_name(a), of, name);
    }
  }
  text_.push_back('\n');
}

void SampleTable::put(const double* position, const double* velocity) {
  for (std::size_t a = 0; a < path_.dimensions(); ++a) {
    if (unit_ > 0.0)
      fmt::format_to(std::back_inserter(text_), ",{}", in_units(position[a], unit_));
    else
      fmt::format_to(std::back_inserter(text_), ",{:.12f},{:.6f}", position[a] * 1e3, velocity[a] * 1e3);
  }
}

void SampleTable::row(std::int64_t k, const double* position, const double* velocity, const Sample* motion) {
  fmt::format_to(std::back_inserter(text_), "{:.9g}", static_cast<double>(k) * period_);
  put(position, velocity);
  if (motion != nullptr) put(motion->position.data(), motion->velocity.data());
  text_.push_back('\n');
  if (text_.size() > 60000) flush();
}

void SampleTable::flush() {
  out_.write(text_.data(), static_cast<std::streamsize>(text_.size()));
  text_.clear();
}

void visit_samples(const ProgramResult& result, const SampleVisitor& visit, Steady steady, MotionOf of) {
  Motion motion(result.plan, result.sample_period, of == MotionOf::servo);
  for (Sample sample; motion.next(sample);) {
    visit(sample.number, sample.position.data(), sample.velocity.data());
    if (steady == Steady::passed) motion.pass_steady();
  }
}

void write_samples(const ProgramResult& result, std::ostream& out) {
  const FilteredCommand* command = result.plan.command();
  const bool servo = command != nullptr && !command->moved.empty();
  SampleTable table(result.plan.path, result.sample_period, out, servo, result.task_machine.position_unit);
  Motion behind(result.plan, result.sample_period, true);
  Sample motion;
  visit_samples(result, [&](std::int64_t k, const double* x, const double* v) {
    if (servo) behind.next(motion);
    table.row(k, x, v, servo ? &motion : nullptr);
  });
}

void stream_row(const Toolpath& path, const double* position, std::ostream& out, double unit) {
  for (std::size_t a = 0; a < path.dimensions(); ++a) {
    out << (a == 0 ? "" : " ")
        << (unit > 0.0 ? fmt::format("{}", in_units(position[a], unit)) : fmt::format("{:.12f}", position[a] * 1e3));
  }
  out << std::endl;  // the controller waits for it
}

void stream_samples(const ProgramResult& result, std::ostream& out) {
  visit_samples(result, [&](std::int64_t, const double* x, const double*) {
    stream_row(result.plan.path, x, out, result.task_machine.position_unit);
  });
}

std::string describe(const PlanTime& plan) {
  const bool checked = plan.time > 0.0;
  return fmt::format("plan {}{}", plan.plan,
                     plan.verified ? ""
                     : checked     ? ", not verified"
                                   : ", not checked within the time limit");
}

std::string describe(const CornerBound& bound) {
  if (bound.corners == 0) return "no corner grants a tolerance";
  return fmt::format("{} of {} corners have legs long enough to count, {} linear programs{}", bound.counted,
                     bound.corners, bound.classes, bound.complete ? "" : ", not all of them solved");
}

std::vector<NamedBound> named_bounds(double lower_bound, const std::optional<CornerBound>& corner_bound) {
  std::vector<NamedBound> bounds{
      {"way over feed", lower_bound,
       "any motion that passes every corner within its tolerance, wherever it runs between them"}};
  if (corner_bound && corner_bound->any_motion > 0.0) {
    const bool complete = corner_bound->any_motion_complete;
    bounds.push_back(
        {"any motion", corner_bound->any_motion,
         fmt::format("any motion within the tolerance of its path, even if it swings out before a corner{}",
                     complete ? "" : "; not all of its linear programs solved"),
         complete});
  }
  if (corner_bound) {
    bounds.push_back(
        {"monotone legs", corner_bound->time,
         "sums of legs that never run back, as filters and profiles make them; free motions may be faster; " +
             describe(*corner_bound),
         corner_bound->complete});
  }
  return bounds;
}

std::vector<NamedBound> bounds_of(const ProgramResult& result) {
  const bool any = result.lower_bound > 0.0 || result.corner_bound;
  return any ? named_bounds(result.lower_bound, result.corner_bound) : std::vector<NamedBound>{};
}

nlohmann::ordered_json bounds_to_json(const std::vector<NamedBound>& bounds) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const NamedBound& bound : bounds) {
    list.push_back(
        {{"name", bound.name}, {"time_s", bound.time}, {"motions", bound.motions}, {"complete", bound.complete}});
  }
  return list;
}

nlohmann::ordered_json corner_bound_to_json(const CornerBound& bound) {
  return {
      {"corners", bound.corners}, {"counted", bound.counted}, {"classes", bound.classes}, {"complete", bound.complete}};
}

nlohmann::ordered_json plan_times_to_json(const std::vector<PlanTime>& plans) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const PlanTime& plan : plans) {
    if (plan.time > 0.0)
      list.push_back({{"plan", plan.plan}, {"cycle_time_s", plan.time}, {"verified", plan.verified}});
  }
  return list;
}

}  // namespace accdec
