#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include <accdec/comparison/comparison_case.hpp>
#include <accdec/comparison/suite_file.hpp>
#include <accdec/instances/instance.hpp>

namespace accdec::comparison {

/// The whole choice of a `design` case. @throws std::invalid_argument for more taps than its rows allow, or a servo
instances::Choice choice_of(const ComparisonCase& subject);

/// A case as data: the sparse form with its first start, or the whole choice for Question::design.
/// @throws std::invalid_argument if it cannot be written down, with the reason
instances::Instance instance_of(const ComparisonCase& subject);

struct InstanceOptions {
  std::string format;  ///< nl, mps, cbf or dat-s
  std::string out;     ///< folder
  bool optima = true;  ///< computes the proved optimum of every problem, within the suite's reference_time_limit_s
  std::string command, version;
  std::function<void(const std::string&)> tell{};  ///< called with the name of every problem
};

struct InstanceSummary {
  std::size_t written = 0, left_out = 0, proved = 0;
};

/// Writes every problem of a suite as a file, with its names in .row and .col, and a manifest.json. The manifest gives
/// kind, sizes, task, proved optimum and licence of each. A problem that the format cannot hold stands there with the
/// reason. A `design` problem has its result with the certificate beside it, for `accdec verify`.
/// @throws OutputError, and for an unknown format std::invalid_argument
InstanceSummary write_instances(const Suite& suite, const InstanceOptions& options);

}  // namespace accdec::comparison
