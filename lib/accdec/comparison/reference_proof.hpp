#pragma once

#include <memory>
#include <optional>
#include <vector>

#include <accdec/certificate/instance_proof.hpp>
#include <accdec/comparison/comparison_case.hpp>
#include <accdec/exact/relaxation.hpp>

namespace accdec::comparison {

/// The order, delays, samples and frequencies that a `margin` or `delay` problem fixes.
InstanceProof::Place place_of(const ComparisonCase& subject);
/// The certificate of a `margin` or `delay` problem's bound; null without parts.
/// @param lower  none: no filter holds all limits
std::shared_ptr<const InstanceProof> instance_proof_of(const ComparisonCase& subject, std::optional<double> lower,
                                                       std::vector<InstanceProof::Part> parts);
/// The certificate of linear programs as the one part that there is; none of null.
std::vector<InstanceProof::Part> one_part(const std::shared_ptr<const Certificate>& certificate);
/// That one linear program refutes all filters.
std::shared_ptr<const Certificate> certificate_of(const Task& task, const exact::Outcome& refuted);

}  // namespace accdec::comparison
