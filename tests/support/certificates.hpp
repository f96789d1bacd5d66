#pragma once

#include <nlohmann/json.hpp>

#include <accdec/certificate.hpp>
#include <accdec/formats/certificate_json.hpp>
#include <accdec/result.hpp>

namespace accdec::testing {

/// A result's certificate as a forger sees it in the file.
inline nlohmann::json certificate_json(const DesignResult& result) {
  return nlohmann::json::parse(certificate_to_json(*result.certificate));
}

/// The report on a result with another certificate in its file: the file is read as usual, then checked.
inline CheckReport check_forged(const Task& task, const DesignResult& result, const nlohmann::json& certificate) {
  DesignResult forged = result;
  forged.certificate.reset();
  nlohmann::json file = nlohmann::json::parse(result_to_json(forged));
  file["certificate"] = certificate;
  try {
    forged.certificate = parse_result(file.dump(), "forged.json").certificate;
  } catch (const InputError& e) {
    return {false, std::string("the certificate cannot be read: ") + e.what()};
  }
  return check_certificate(task, forged);
}

}  // namespace accdec::testing
