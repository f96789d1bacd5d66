#include <algorithm>

#include <nlohmann/json.hpp>

#include <accdec/formats/certificate_json.hpp>
#include <accdec/formats/instance_proof_json.hpp>
#include <accdec/formats/json_number.hpp>
#include <accdec/formats/json_text.hpp>
#include <accdec/formats/json_value.hpp>
#include <accdec/formats/task_json.hpp>
#include <accdec/formats/task_writer.hpp>

namespace accdec {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* schema = "accdec.refutation/1";

InstanceProof read(const Value& value, const std::string& name) {
  value.members({"schema", "formulation", "lower", "at", "task", "parts"});
  if (value["schema"].text() != schema) value["schema"].fail(fmt::format("must be \"{}\"", schema));
  InstanceProof r;
  const std::string formulation = value["formulation"].text();
  if (formulation != "margin" && formulation != "delay") value["formulation"].fail("allowed are margin, delay");
  r.of_delay = formulation == "delay";
  r.lower = value["lower"].optional_number();
  r.task = parse_task_json(value["task"].json().dump(), name, {.response = Considered::all, .controller_files = false});
  const Value at = value["at"];
  at.members({"order", "delays", "frequencies"}, {"samples"});
  r.at.order = at["order"].integer<int>();
  r.at.delays = at["delays"].integers<int>();
  if (at.has("samples")) r.at.samples = at["samples"].integers<int>();
  for (const Value& mode : at["frequencies"].elements()) r.at.frequencies.push_back(mode.numbers());
  for (const Value& entry : value["parts"].elements()) {
    entry.members({"certificate"}, {"corner", "delay"});
    if (entry.has("corner") != entry.has("delay")) entry.fail("has both a `corner` and a `delay`, or neither");
    InstanceProof::Part part;
    if (entry.has("corner")) {
      part.corner = entry["corner"].integer<int>();
      part.delay = entry["delay"].number();
    }
    part.certificate = read_certificate(entry["certificate"]);
    r.parts.push_back(std::move(part));
  }
  return r;
}

}  // namespace

Json place_to_json(const InstanceProof::Place& place, bool of_delay) {
  Json at = {{"order", place.order}, {"delays", place.delays}};
  if (!of_delay) at["samples"] = place.samples;
  at["frequencies"] = place.frequencies;
  return at;
}

std::string instance_proof_to_json(const InstanceProof& r) {
  Json at = place_to_json(r.at, r.of_delay);
  at.erase("frequencies");
  const Json head = {{"schema", schema},
                     {"formulation", r.of_delay ? "delay" : "margin"},
                     {"lower", r.lower ? Json(*r.lower) : Json(nullptr)},
                     {"task", task_to_json(r.task)},
                     {"at", std::move(at)}};
  std::string text = head.dump(2, ' ', false, Json::error_handler_t::replace);
  text.resize(text.size() - 6);  // without the ends of both objects
  // Written as in rows, digit for digit: there are readers of exact numbers.
  text += ",\n    \"frequencies\": [";
  for (const std::vector<double>& mode : r.at.frequencies) {
    text += &mode == r.at.frequencies.data() ? "[" : ", [";
    for (const double& f : mode) append_number(text += &f == mode.data() ? "" : ", ", f);
    text += "]";
  }
  // Certificates are long: they are written as text.
  text += "]\n  },\n  \"parts\": [";
  for (const InstanceProof::Part& part : r.parts) {
    text += &part == r.parts.data() ? "\n    {" : ",\n    {";
    if (part.corner) text += fmt::format("\"corner\": {}, \"delay\": {}, ", *part.corner, Json(part.delay).dump());
    text += "\"certificate\": " + stored_certificate(part.certificate) + "}";
  }
  return text + "\n  ]\n}\n";
}

bool is_instance_proof(std::string_view text) {
  return text.substr(0, 200).find(fmt::format("\"{}\"", schema)) != std::string_view::npos;
}

InstanceProof parse_instance_proof(std::string_view text, const std::string& name) {
  const Json json = parse_json_text(text, name);
  try {
    return read(Value(json, ""), name);
  } catch (const Mistake& mistake) {
    throw at_its_place(InputError("", 0, 0, mistake.message, mistake.pointer), text, name);
  }
}

}  // namespace accdec
