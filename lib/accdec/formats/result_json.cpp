#include <algorithm>
#include <cmath>
#include <concepts>
#include <iterator>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <accdec/formats/certificate_json.hpp>
#include <accdec/formats/json_number.hpp>
#include <accdec/formats/settings_json.hpp>
#include <accdec/formats/task_writer.hpp>
#include <accdec/machine/limit_unit.hpp>
#include <accdec/result.hpp>
#include <accdec/task/not_considered.hpp>
#include <accdec/task/settings_text.hpp>

namespace accdec {
namespace {

using Json = nlohmann::ordered_json;

Json number(double x) {
  return std::isfinite(x) ? Json(x) : Json(nullptr);
}
Json number(const std::optional<double>& x) {
  return x ? number(*x) : Json(nullptr);
}

/// Writes the elements of long lists directly. There may be a hundred thousand corners and several times as many
/// limits: as a tree they take ten times the memory and most of the time.
class ListWriter {
 public:
  explicit ListWriter(std::string& out) : out_(out) {}

  ListWriter& begin() {
    out_ += first_element_ ? "\n    {" : ",\n    {";
    first_element_ = false;
    first_member_ = true;
    return *this;
  }
  ListWriter& member(std::string_view name, std::string_view word) {
    key(name);
    const bool plain =
        std::all_of(word.begin(), word.end(), [](char c) { return c >= ' ' && c < 0x7F && c != '"' && c != '\\'; });
    if (plain)
      (out_ += '"').append(word) += '"';
    else
      out_ += Json(word).dump(-1, ' ', false, Json::error_handler_t::replace);
    return *this;
  }
  ListWriter& member(std::string_view name, double value) {
    key(name);
    if (!std::isfinite(value)) {
      out_ += "null";
      return *this;
    }
    append_number(out_, value);
    return *this;
  }
  template <std::integral Integer>
  ListWriter& member(std::string_view name, Integer value) {
    key(name);
    out_ += std::to_string(value);
    return *this;
  }
  void end() { out_ += "\n    }"; }

 private:
  void key(std::string_view name) {
    out_ += first_member_ ? "\n      \"" : ",\n      \"";
    out_ += name;
    out_ += "\": ";
    first_member_ = false;
  }

  std::string& out_;
  bool first_element_ = true, first_member_ = true;
};

/// "name": [ .. ] as a member of the result, element by element.
template <class Element, class Write>
void append_list(std::string& out, std::string_view name, const std::vector<Element>& list, Write write) {
  fmt::format_to(std::back_inserter(out), ",\n  \"{}\": [", name);
  ListWriter writer(out);
  for (const Element& element : list) {
    writer.begin();
    write(writer, element);
    writer.end();
  }
  out += list.empty() ? "]" : "\n  ]";
}

void write_corner(ListWriter& writer, const CornerResult& c) {
  writer.member("name", c.name)
      .member("delay_samples", c.delay)
      .member("corner_error_m", c.corner_error)
      .member("polyline_error_m", c.polyline_error)
      .member("contour_deviation_m", c.contour_deviation)
      .member("speed_min_m_s", c.speed_min)
      .member("corner_time_s", c.corner_time);
  if (c.settling_time > 0.0) writer.member("settling_time_s", c.settling_time);
  if (c.feed_part < 1.0) writer.member("feed_part", c.feed_part);
}

void write_limit(ListWriter& writer, const LimitUse& use) {
  const double in_si = si_over_inside(use.kind, use.axis);
  writer.member("kind", to_string(use.kind))
      .member("axis", use.axis)
      .member("corner", use.corner)
      .member("event", to_string(use.event))
      .member("value", in_si * use.value)
      .member("bound", in_si * use.bound)
      .member("utilisation", use.utilisation)
      .member("sample", use.sample);
  if (of_mode(use.kind)) writer.member("frequency_Hz", use.frequency);
  if (use.damping > 0.0) writer.member("damping_ratio", use.damping);
}

/// The members of an object as text, without its brackets.
std::string members_text(const Json& object) {
  const std::string text = object.dump(2, ' ', false, Json::error_handler_t::replace);
  return text.substr(1, text.size() - 3);
}

/// The members behind the lists, but for the certificate.
Json tail_of(const DesignResult& result) {
  Json tail;
  const VerificationReport& v = result.verification;
  tail["verification"] = {
      {"performed", v.performed},    {"feasible", v.feasible}, {"max_violation", number(v.max_violation)},
      {"tolerance", v.tolerance},    {"worst", v.worst},       {"certificate_checked", v.certificate_checked},
      {"certificate", v.certificate}};
  const SolverReport& s = result.solver;
  tail["solver"] = {{"method", s.method},           {"name", s.name},
                    {"version", s.version},         {"claimed", s.claimed},
                    {"evaluations", s.evaluations}, {"wall_time_s", number(s.wall_time)}};
  if (result.quantisation) {
    const Quantisation& q = *result.quantisation;
    tail["quantisation"] = {
        {"bits", q.bits}, {"coefficients", q.coefficients}, {"unquantised_s", number(q.unquantised)}};
  }
  if (result.savings) {
    const Savings& saved = *result.savings;
    tail["savings"] = {{"today_s", saved.today},
                       {"total_s", saved.total},
                       {"by_retuning_s", number(saved.by_retuning)},
                       {"by_family_s", number(saved.by_family)},
                       {"by_free_taps_s", number(saved.by_taps)},
                       {"family", saved.family},
                       {"complete", saved.complete}};
  }
  return tail;
}

}  // namespace

std::size_t proof_size(const DesignResult& result) {
  if (!result.certificate) return 0;
  return certificate_to_json(*result.certificate).size();
}

std::string result_to_json(const DesignResult& result) {
  Json head;
  head["schema"] = "accdec.result/1";
  head["status"] = to_string(result.status);
  head["message"] = result.message;
  head["stop"] = to_string(result.stop);
  head["task"] = task_to_json(result.task);
  Json left_out = Json::array();
  for (const NotConsidered what : not_considered(result.task.machine)) left_out.push_back(to_string(what));
  head["not_considered"] = std::move(left_out);
  head["sample_period_s"] = result.task.sample_period;
  head["filter"] = nullptr;
  if (result.filter) {
    const auto taps = result.filter->taps();
    head["filter"] = {{"order", result.filter->order()}, {"taps", std::vector<double>(taps.begin(), taps.end())}};
  }
  const Json times{{"cycle_time_s", number(result.cycle_time)},
                   {"corner_time_s", number(result.corner_time)},
                   {"lower_bound_s", number(result.lower_bound)},
                   {"gap", number(result.gap)}};
  Json settings;
  if (result.settings) {
    settings["settings"] = settings_to_json(result);
    settings["family_bound_s"] = number(result.family_bound);
    settings["free_taps_s"] = number(result.free_taps);
  } else if (const std::string answer = settings_answer(result); !answer.empty()) {
    settings["answer"] = answer.substr(0, answer.size() - 1);  // without its line feed
  }
  std::string text;
  // For a hundred thousand corners the text has some hundred megabytes: growing step by step would copy it once more.
  text.reserve(1000 + 320 * (result.task.corners.size() + result.corners.size()) + 280 * result.limits.size());
  text += "{";
  text += members_text(head);
  append_list(text, "corners", result.corners, write_corner);
  text += "," + members_text(times);
  if (!settings.is_null()) text += "," + members_text(settings);
  append_list(text, "limits", result.limits, write_limit);
  text += "," + members_text(tail_of(result));
  if (result.certificate) text += ",\n  \"certificate\": " + stored_certificate(*result.certificate);
  text += "\n}\n";
  return text;
}

}  // namespace accdec
