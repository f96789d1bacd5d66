#include <algorithm>
#include <array>

#include <fmt/format.h>

#include <accdec/formats/rotary_table.hpp>
#include <accdec/formats/si_names.hpp>

namespace accdec {
namespace {

struct RotaryKey {
  std::string_view of_linear, key, meaning, unit;
  double most;
  std::string_view example;
  double Axis::*value;
};
constexpr std::array<RotaryKey, 8> all_keys{
    {{"velocity_max_mm_s", "velocity_max_deg_s", "axes a, b, c: largest velocity", "deg/s", 1e6, "180",
      &Axis::velocity_max},
     {"acceleration_max_mm_s2", "acceleration_max_deg_s2", "axes a, b, c: largest acceleration", "deg/s^2", 1e8, "2000",
      &Axis::acceleration_max},
     {"jerk_max_mm_s3", "jerk_max_deg_s3", "axes a, b, c: largest jerk", "deg/s^3", 1e12, "100000", &Axis::jerk_max},
     {"mass_kg", "inertia_kg_m2", "axes a, b, c: moved moment of inertia, instead of the mass", "kg m^2", 1e6, "0.8",
      &Axis::mass},
     {"damping_N_s_m", "damping_N_m_s", "axes a, b, c: viscous friction", "N m s", 1e8, "0.3", &Axis::damping},
     {"coulomb_N", "coulomb_N_m", "axes a, b, c: dry friction", "N m", 1e8, "0.5", &Axis::coulomb},
     {"force_rms_N", "torque_rms_N_m", "axes a, b, c: rating, as `force_rms_N`", "N m", 1e8, "20",
      &Axis::force_rms_max},
     {"force_max_N", "torque_max_N_m", "axes a, b, c: largest torque; needs inertia", "N m", 1e8, "40",
      &Axis::force_max}}};

}  // namespace

std::vector<Key> rotary_keys() {
  std::vector<Key> keys;
  for (const RotaryKey& one : all_keys)
    keys.push_back({.name = std::string(one.key),
                    .meaning = std::string(one.meaning),
                    .unit = std::string(one.unit),
                    .range = {0.0, one.most, Axis{}.*one.value != 0.0},  // none of it is what a missing key says
                    .fallback = Axis{}.*one.value == 0.0 ? "0" : "no limit",
                    .example = std::string(one.example)});
  return keys;
}

std::string_view rotary_key(std::string_view key) {
  if (key == force_speed_key) return torque_speed_key;
  const auto found = std::ranges::find(all_keys, key, &RotaryKey::of_linear);
  return found == all_keys.end() ? key : found->key;
}

bool is_rotary_key(std::string_view key) {
  return key == torque_speed_key || std::ranges::find(all_keys, key, &RotaryKey::key) != all_keys.end();
}

std::vector<std::pair<std::string, double>> rotary_in_si(const Axis& axis) {
  std::vector<std::pair<std::string, double>> values;
  for (const Key& key : rotary_keys()) {
    const double inside = axis.*std::ranges::find(all_keys, key.name, &RotaryKey::key)->value;
    values.emplace_back(si_name(key), inside < unlimited ? to_named_si(key, from_si(key, inside)) : unlimited);
  }
  return values;
}

void refuse_rotary(const toml_input::Table& table) {
  const auto refuse = [&](std::string_view key) {
    if (table.has(key))
      table.fail_at(key, fmt::format("`{}` is for a rotary axis, and the only [[axis]] stands for all axes; allowed "
                                     "is one [[axis]] an axis",
                                     key));
  };
  for (const RotaryKey& one : all_keys) refuse(one.key);
  refuse(torque_speed_key);
}

void read_rotary(const toml_input::Table& table, Axis& axis, std::vector<std::string>& notes) {
  const bool turns = is_rotary(axis.name);
  const auto require_alone = [&](std::string_view key, std::string_view of_linear) {
    if (!turns) table.fail_at(key, fmt::format("`{}` is for rotary axes; allowed on axes named a, b and c", key));
    if (table.has(of_linear))
      table.fail_at(key, fmt::format("`{}` and `{}` are both given; allowed is either", key, of_linear));
  };
  if (table.has(torque_speed_key)) require_alone(torque_speed_key, force_speed_key);
  for (const RotaryKey& one : all_keys) {
    if (table.has(one.key)) {
      require_alone(one.key, one.of_linear);
      axis.*one.value = *table.number(one.key);
    } else if (turns && table.has(one.of_linear)) {
      notes.push_back(fmt::format("`{}` of axis {} counts a degree as a millimetre; `{}` says so", one.of_linear,
                                  axis.name, one.key));
    }
  }
  if (turns && table.has(force_speed_key))
    notes.push_back(
        fmt::format("`{}` of axis {} counts a degree as a millimetre: 1 deg/s is 1 mm/s there, and 1 N m "
                    "is {:.6g} N; `{}` says so",
                    force_speed_key, axis.name, radians_per_metre, torque_speed_key));
}

}  // namespace accdec
