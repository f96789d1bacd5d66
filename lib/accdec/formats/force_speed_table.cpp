#include <utility>

#include <fmt/format.h>

#include <accdec/files/units.hpp>
#include <accdec/formats/force_speed_table.hpp>
#include <accdec/machine/limit_unit.hpp>
#include <accdec/machine/limits.hpp>

namespace accdec {
namespace {

using toml_input::Table;

/// N s/m, how fast the curve falls behind a point.
double fall(const std::vector<SpeedForce>& curve, std::size_t i) {
  return (curve[i].force - curve[i + 1].force) / (curve[i + 1].speed - curve[i].speed);
}

/// Straight points given in decimals may be off by rounding.
constexpr double rounding = 1.0 - 1e-9;

std::string_view curve_key(const Table& table) {
  return table.has(torque_speed_key) ? torque_speed_key : force_speed_key;
}

/// Stand-ins for the two numbers of a point, with their units.
std::pair<Key, Key> units_of(std::string_view key) {
  const bool turns = key == torque_speed_key;
  return {{.name = "speed", .unit = turns ? "deg/s" : "mm/s"}, {.name = "force", .unit = turns ? "N m" : "N"}};
}

void check_drive(const Table& table, const Axis& axis) {
  if (!(axis.coulomb > 0.0)) return;
  const std::string_view key = table.has("coulomb_N_m") ? "coulomb_N_m" : "coulomb_N";
  const auto refuse = [&](std::string_view limit, double least) {
    const double unit = key == "coulomb_N_m" ? radians_per_metre : 1.0;
    table.fail_at(key, fmt::format("`{}` = {:g} is not below `{}` = {:g}: the axis could never move", key,
                                   axis.coulomb / unit, limit, least / unit));
  };
  if (axis.coulomb >= axis.force_max)
    refuse(table.has("force_max_N") ? "force_max_N" : "torque_max_N_m", axis.force_max);
  if (axis.coulomb >= axis.force_speed_max) refuse(curve_key(table), axis.force_speed_max);
}

}  // namespace

Key force_speed_of_files() {
  return {.name = std::string(force_speed_key),
          .type = KeyType::numbers,
          .meaning =
              "largest force by speed, [[mm/s, N], ..]: straight in between, the first force below its speed, "
              "nothing beyond the last",
          .unit = "mm/s and N",
          .range = {0.0, 1e8},
          .least = 2,
          .most = 100,
          .fallback = "no limit",
          .example = "[[0, 500], [200, 400], [400, 200]]",
          .pairs = true};
}

Key torque_speed_of_files() {
  Key key = force_speed_of_files();
  key.name = std::string(torque_speed_key);
  key.meaning = "axes a, b, c: largest torque by speed, [[deg/s, N m], ..], as `force_speed_N`";
  key.unit = "deg/s and N m";
  key.example = "[[0, 40], [180, 30], [360, 10]]";
  return key;
}

nlohmann::ordered_json curve_of_files(std::string_view key, const Axis& axis) {
  // It is another than the one read where a study or a lever has set its bound.
  const double scale = axis.force_speed_max / axis.force_speed.front().force;
  const auto [speed, force] = units_of(key);
  auto curve = nlohmann::ordered_json::array();
  for (const SpeedForce& point : axis.force_speed)
    curve.push_back({from_si(speed, scale * point.speed), from_si(force, scale * point.force)});
  return curve;
}

void read_force_speed(const Table& table, Axis& axis) {
  const std::string_view key = curve_key(table);
  std::vector<SpeedForce>& curve = axis.force_speed;
  const auto [speed, force] = units_of(key);
  for (const auto& [v, f] : table.pairs(key)) curve.push_back({to_si(speed, v), to_si(force, f)});
  if (curve.empty()) return;
  if (!(curve.front().force > 0.0)) table.fail_at(key, 0, fmt::format("`{}` begins without any force", key));
  for (std::size_t i = 1; i < curve.size(); ++i) {
    if (!(curve[i].speed > curve[i - 1].speed))
      table.fail_at(key, i, fmt::format("`{}`: speeds must rise from point to point", key));
    if (curve[i].force > curve[i - 1].force)
      table.fail_at(key, i, fmt::format("`{}`: forces must not rise from point to point", key));
  }
  for (std::size_t i = 1; i + 1 < curve.size(); ++i) {
    if (fall(curve, i) < rounding * fall(curve, i - 1))
      table.fail_at(key, i,
                    fmt::format("`{}`: the curve falls less behind {:g} {} than before it; allowed is one "
                                "that falls more and more. A branch of constant power is `power_max_W` beside `{}`",
                                key, 1e3 * curve[i].speed, key == torque_speed_key ? "deg/s" : "mm/s",
                                key == torque_speed_key ? "torque_max_N_m" : "force_max_N"));
  }
  axis.force_speed_max = curve.front().force;
}

void check_friction(const std::vector<Table>& axes, const Task& task) {
  for (std::size_t a = 0; a < task.machine.axes.size() && !axes.empty(); ++a) {
    const bool moves = task.corners.empty() || std::ranges::any_of(task.corners, [a](const TaskCorner& corner) {
                         const auto i = static_cast<Eigen::Index>(a);
                         return corner.geometry().direction_in[i] != 0.0 || corner.geometry().direction_out[i] != 0.0;
                       });
    if (moves) check_drive(axes[std::min(a, axes.size() - 1)], task.machine.axes[a]);
  }
}

void require_load(const Table& table, const Axis& axis) {
  if (axis.mass > 0.0 || axis.damping > 0.0) return;
  const bool turns = is_rotary(axis.name), dry = axis.coulomb > 0.0;
  const std::string mass = turns ? "inertia_kg_m2" : "mass_kg", damping = turns ? "damping_N_m_s" : "damping_N_s_m";
  const std::string with_mass = mass + " or " + damping,
                    any_load = mass + ", " + damping + " or " + (turns ? "coulomb_N_m" : "coulomb_N");
  const auto refuse = [&](std::string_view of_linear, std::string_view why, const std::string& give) {
    const std::string_view of_rotary = of_linear == "force_rms_N" ? "torque_rms_N_m" : "torque_max_N_m";
    const std::string_view key = table.has(of_linear) ? of_linear : of_rotary;
    table.fail_at(key, fmt::format("`{}` can never bind: {}; give {}", key, why, give));
  };
  const std::string_view nothing = "an axis without mass, damping and dry friction needs no force";
  // Dry friction alone takes power, and breaks a force or a curve below it.
  if (axis.force_max < unlimited && axis.coulomb < axis.force_max)
    refuse("force_max_N", dry ? "without mass and damping the force is the dry friction, which is less" : nothing,
           with_mass);
  if (axis.regeneration_max < unlimited)
    refuse("regeneration_max_W", dry ? "without mass and damping nothing is left to brake" : nothing, with_mass);
  if (dry) return;
  if (axis.power_max < unlimited) refuse("power_max_W", nothing, any_load);
  if (axis.force_rms_max < unlimited) refuse("force_rms_N", nothing, any_load);
  if (axis.force_speed_max < unlimited)
    table.fail_at(curve_key(table),
                  fmt::format("`{}` bounds only the speed: {}; give {}, or {} in place of the curve", curve_key(table),
                              nothing, any_load, turns ? "velocity_max_deg_s" : "velocity_max_mm_s"));
}

}  // namespace accdec
