#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include <httplib.h>

namespace accdec::explore {

struct Refusal {
  int status = 400;  ///< as HTTP has it
  const char* why = "";
};

/// Which requests are the page's own: those that know the random token of its address, come to the host it was opened
/// with, and from no other origin.
class Admission {
 public:
  /// @throws std::runtime_error if the system has no random number
  Admission();
  const std::string& token() const { return token_; }
  /// Why a request is not the page's own, from its head alone. @param port  of this server
  std::optional<Refusal> refusal(const httplib::Request& request, int port) const;

 private:
  std::string token_;
};

/// The time that a request asks for, 1 s if it names none; null if it is none that is allowed.
std::optional<double> seconds_of(const httplib::Request& request);
/// The corner or the result that a request asks for, 0 if it names none; null if it is no whole number.
std::optional<std::size_t> number_of(const httplib::Request& request, const char* name);

}  // namespace accdec::explore
