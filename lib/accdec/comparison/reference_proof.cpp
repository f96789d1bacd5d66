#include <accdec/comparison/reference_proof.hpp>
#include <accdec/comparison/refutation_tree.hpp>
#include <accdec/design/limit_rows.hpp>

namespace accdec::comparison {

InstanceProof::Place place_of(const ComparisonCase& subject) {
  const CaseSpec& spec = subject.spec();
  return {spec.order, spec.question == Question::delay ? subject.blend_delays() : spec.delays, subject.samples(),
          initial_frequencies(spec.task, spec.order)};
}

std::shared_ptr<const InstanceProof> instance_proof_of(const ComparisonCase& subject, std::optional<double> lower,
                                                       std::vector<InstanceProof::Part> parts) {
  if (parts.empty()) return nullptr;
  const CaseSpec& spec = subject.spec();
  InstanceProof r;
  r.task = spec.task;
  r.of_delay = spec.question == Question::delay;
  r.at = place_of(subject);
  r.lower = lower;
  r.parts = std::move(parts);
  return std::make_shared<const InstanceProof>(std::move(r));
}

std::vector<InstanceProof::Part> one_part(const std::shared_ptr<const Certificate>& certificate) {
  std::vector<InstanceProof::Part> parts;
  if (certificate) parts.push_back({std::nullopt, 0.0, *certificate});
  return parts;
}

std::shared_ptr<const Certificate> certificate_of(const Task& task, const exact::Outcome& refuted) {
  RefutationTree tree;
  // Without multipliers it was the tube.
  if (refuted.multipliers.empty())
    tree.close(0, proof::Unreachable{});
  else
    tree.close(0, proof::Refuted{tree.keep(refuted.multipliers)});
  return tree.certificate(task);
}

}  // namespace accdec::comparison
