#include <algorithm>
#include <array>
#include <cctype>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <set>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/batch/row_numbers.hpp>
#include <accdec/comparison/reference_proof.hpp>
#include <accdec/comparison/suite_instances.hpp>
#include <accdec/design/anytime.hpp>
#include <accdec/exact/exact.hpp>
#include <accdec/files.hpp>
#include <accdec/files/output_files.hpp>
#include <accdec/files/results_folder.hpp>
#include <accdec/files/text_file.hpp>
#include <accdec/formats/instance_proof_json.hpp>
#include <accdec/formats/manifest.hpp>
#include <accdec/formats/task_writer.hpp>
#include <accdec/task/contradictions.hpp>

namespace accdec::comparison {
namespace {

using Json = nlohmann::ordered_json;

/// The rows of a choice grow with the square of the order.
constexpr int most_choice_order = 200;

std::string stem_of(const CaseSpec& spec) {
  std::string stem;
  for (const unsigned char c : spec.name) {
    if (std::isalnum(c))
      stem += static_cast<char>(std::tolower(c));
    else if (!stem.empty() && stem.back() != '-')
      stem += '-';
  }
  while (!stem.empty() && stem.back() == '-') stem.pop_back();
  return fmt::format("{}.{}.{}", stem.empty() ? "problem" : stem, to_string(spec.question), spec.size);
}

/// One name a line. Readers end a name at a space.
std::string lines(const std::vector<std::string>& names) {
  std::string text;
  std::set<std::string> taken;
  for (std::string name : names) {
    std::replace(name.begin(), name.end(), ' ', '_');
    while (!taken.insert(name).second) name += '_';  // "A b" and "A_b" are different corners
    text += name + '\n';
  }
  return text;
}

/// The limits that a file in any format states otherwise than the task.
std::string beside_the_task(const CaseSpec& spec) {
  const auto band = [](const Mode& m) { return m.frequency_low < m.frequency_high || m.damping_low < m.damping_high; };
  std::string text;
  if (std::ranges::any_of(spec.task.machine.modes, band)) {
    text = "; a mode's band is bounded at single frequencies, and at the ends of its damping";
    text += spec.question == Question::design ? ": a lower bound of the optimum here, which holds over the whole band"
                                              : ", in the optimum here as well";
  }
  if (std::ranges::any_of(spec.task.corners, [](const TaskCorner& c) { return c.contour_max.has_value(); }))
    text += "; a contour is bounded for the time at which the start passes from leg to leg";
  return text;
}

/// Collects the files and the manifest.
class Writer {
 public:
  Writer(const Suite& suite, const InstanceOptions& options) : suite_(suite), options_(options) {
    manifest_["schema"] = "accdec.instances/1";
    manifest_["command"] = options.command;
    manifest_["suite"] = suite.settings.title;
    manifest_["format"] = options.format;
    manifest_["licence"] = "Apache-2.0";
    manifest_["instances"] = Json::array();
  }

  void add(const CaseSpec& spec) {
    if (options_.tell) options_.tell(spec.name);
    const ComparisonCase subject(spec);
    std::string stem = stem_of(spec);
    for (int n = 2; std::find(stems_.begin(), stems_.end(), stem) != stems_.end(); ++n)
      stem = fmt::format("{}.{}", stem_of(spec), n);
    stems_.push_back(stem);
    Json entry;
    describe(entry, "formulation", subject);
    try {
      write(entry, stem, subject);
    } catch (const std::invalid_argument& reason) {
      entry["file"] = nullptr;
      entry["reason"] = reason.what();
      ++summary_.left_out;
    }
    entry["expected"] = to_string(spec.expected);
    if (spec.question != Question::design && subject.objection().empty())
      entry["at"] = place_to_json(place_of(subject), spec.question == Question::delay);
    if (options_.optima) optimum(entry, stem, subject);
    entry["task"] = task_to_json(spec.task);
    manifest_["instances"].push_back(std::move(entry));
  }

  /// Names of files in the folder, after `finish`.
  const std::vector<std::string>& written() const { return written_; }

  InstanceSummary finish() {
    add_environment(manifest_, options_.version);
    OutputFiles output;
    output.add((std::filesystem::path(options_.out) / "manifest.json").string(), manifest_.dump(1) + "\n");
    for (auto& [name, content] : files_) {
      written_.push_back(name);
      output.add((std::filesystem::path(options_.out) / name).string(), std::move(content));
    }
    create_results_folder(options_.out);
    output.commit();
    return summary_;
  }

 private:
  void write(Json& entry, const std::string& stem, const ComparisonCase& subject) {
    const instances::Instance instance = instance_of(subject);
    instances::Text text = instances::text_of(instance, options_.format);
    const std::string file = stem + "." + options_.format;
    entry["file"] = file;
    entry["class"] = text.kind;
    entry["relation"] = text.relation + beside_the_task(subject.spec());
    entry["variables"] = text.columns.size();
    entry["binary"] =
        std::count_if(instance.variables.begin(), instance.variables.end(), [](const auto& v) { return v.binary; });
    entry["rows"] = text.rows.size();
    files_.emplace_back(file, std::move(text.content));
    files_.emplace_back(stem + ".row", lines(text.rows));
    files_.emplace_back(stem + ".col", lines(text.columns));
    ++summary_.written;
  }

  void optimum(Json& entry, const std::string& stem, const ComparisonCase& subject) {
    const double limit = suite_.settings.reference_time_limit;
    Reference reference;
    Json certificate = nullptr;
    const CaseSpec& spec = subject.spec();
    if (spec.question == Question::design && subject.objection().empty() && exact_covers(spec.task)) {
      const DesignResult result = exact_at_order(spec, limit, true);
      reference = reference_of(result);
      // A search that ends without a design has no result that both checkers take.
      if (result.status != Status::failed && result.certificate) {
        certificate = stem + ".proof.json";
        files_.emplace_back(stem + ".proof.json", result_to_json(result));
      }
    } else {
      reference = reference_of(subject, limit);
    }
    if (reference.refutation) {
      const auto began = std::chrono::steady_clock::now();
      const CheckReport check =
          check_instance_proof(*reference.refutation, [&] { return seconds_since(began) > limit; });
      if (check.accepted) {
        certificate = stem + ".proof.json";
        files_.emplace_back(stem + ".proof.json", instance_proof_to_json(*reference.refutation));
      }
    }
    if (reference.proof != Reference::Proof::bound) ++summary_.proved;
    entry["optimum"] = {{"proof", to_string(reference.proof)},
                        {"lower", batch::rounded(reference.lower, 17)},
                        {"upper", batch::rounded(reference.upper, 17)},
                        {"method", reference.method},
                        {"certificate", certificate}};
  }

  const Suite& suite_;
  const InstanceOptions& options_;
  Json manifest_;
  std::vector<std::string> stems_;
  std::vector<std::pair<std::string, std::string>> files_;
  std::vector<std::string> written_;
  InstanceSummary summary_;
};

}  // namespace

instances::Choice choice_of(const ComparisonCase& subject) {
  if (subject.spec().order > most_choice_order)
    throw std::invalid_argument(
        fmt::format("a whole choice is written down to order {}: its rows grow with the square", most_choice_order));
  return instances::choice_of(subject.spec().task, subject.spec().order);
}

instances::Instance instance_of(const ComparisonCase& subject) {
  // Rows of a force-speed curve say nothing beyond its last speed. Only whole designs have to hold the tolerance.
  Task task = subject.spec().task;
  if (subject.spec().question != Question::design) {
    for (TaskCorner& corner : task.corners) corner.error_max.reset();
  }
  if (const auto reasons = contradictions(task); !reasons.empty())
    throw std::invalid_argument("no filter of any order holds the task: " + reasons.front());
  if (!subject.objection().empty()) throw std::invalid_argument(subject.objection());
  if (subject.spec().question == Question::design) {
    const instances::Choice choice = choice_of(subject);
    return instances::instance_of(choice.problem, choice.start);
  }
  const auto& problem = dynamic_cast<const QuadraticProblem&>(*subject.problem(false));
  return instances::instance_of(problem, subject.start(false, 0, 1));
}

namespace {

/// The instances that a folder holds; null without any.
Json instances_in(const std::string& folder) {
  const std::filesystem::path path = std::filesystem::path(folder) / "manifest.json";
  if (!std::filesystem::is_regular_file(path)) return nullptr;
  return Json::parse(read_text_file(path.string(), result_file_limit), nullptr, false);
}

/// Removes the files of earlier instances that the new ones did not replace.
void remove_stale(const std::string& folder, const Json& earlier, const std::vector<std::string>& written) {
  for (const Json& entry : earlier.value("instances", Json::array())) {
    if (!entry.is_object()) continue;
    std::vector<std::string> names;
    if (entry.contains("file") && entry["file"].is_string()) {
      const std::string file = entry["file"], stem = file.substr(0, file.rfind('.'));
      names = {file, stem + ".row", stem + ".col"};
    }
    const Json optimum = entry.value("optimum", Json::object());
    if (optimum.contains("certificate") && optimum["certificate"].is_string()) names.push_back(optimum["certificate"]);
    for (const std::string& name : names) {
      // Manifests can be edited: only files of the folder itself are removed.
      const std::filesystem::path path = std::filesystem::path(folder) / name;
      std::error_code ignored;
      const bool plain =
          name.find('/') == std::string::npos && std::filesystem::is_regular_file(symlink_status(path, ignored));
      if (plain && std::find(written.begin(), written.end(), name) == written.end())
        std::filesystem::remove(path, ignored);
    }
  }
}

}  // namespace

InstanceSummary write_instances(const Suite& suite, const InstanceOptions& options) try {
  constexpr std::array formats{"nl", "mps", "cbf", "dat-s"};
  if (std::find(formats.begin(), formats.end(), options.format) == formats.end())
    throw std::invalid_argument(fmt::format("--format {}: allowed are {}", options.format, fmt::join(formats, ", ")));
  require_results_folder(options.out, {"accdec.instances/1", "command", "instances", "accdec instances "});
  const Json earlier = instances_in(options.out);
  const bool named = earlier.is_object() && earlier.contains("format");
  if (named && !earlier["format"].is_string())
    throw OutputError(fmt::format(
        "{}: its manifest.json has no word as `format`; nothing was changed. Choose another --out", options.out));
  if (named && earlier["format"] != options.format)
    throw OutputError(
        fmt::format("{}: holds instances as {}, whose .row and .col have another order; nothing was changed. Choose "
                    "another --out for {}",
                    options.out, earlier["format"].get<std::string>(), options.format));
  Writer writer(suite, options);
  for (const CaseSpec& spec : suite.cases) writer.add(spec);
  const InstanceSummary summary = writer.finish();
  if (earlier.is_object()) remove_stale(options.out, earlier, writer.written());
  return summary;
} catch (const std::filesystem::filesystem_error& error) {
  throw OutputError(fmt::format("{}: {}", error.path1().string(), error.code().message()));
}

}  // namespace accdec::comparison
