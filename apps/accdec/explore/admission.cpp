#include "admission.hpp"

#include <array>
#include <charconv>
#include <stdexcept>
#include <string_view>

#include <sys/random.h>

#include <fmt/format.h>

#include "requests.hpp"

namespace accdec::explore {
namespace {

std::string random_token() {
  std::array<unsigned char, 16> bytes{};
  if (::getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
    throw std::runtime_error("the system has no random numbers for the address");
  std::string token;
  for (const unsigned char byte : bytes) token += fmt::format("{:02x}", byte);
  return token;
}

/// Compares in a time that does not depend on where they differ.
bool same(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned char difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i) difference |= static_cast<unsigned char>(a[i] ^ b[i]);
  return difference == 0;
}

}  // namespace

Admission::Admission() : token_(random_token()) {}

std::optional<Refusal> Admission::refusal(const httplib::Request& request, int port) const {
  const std::string host = fmt::format("127.0.0.1:{}", port);
  if (request.get_header_value_count("Host") != 1 || request.get_header_value("Host") != host)
    return Refusal{403, "another host"};
  const std::size_t origins = request.get_header_value_count("Origin");
  if (origins > 1 || (origins == 1 && request.get_header_value("Origin") != "http://" + host))
    return Refusal{403, "another origin"};
  const std::string_view path = request.path;
  const bool alone = path.size() == token_.size() + 1 && request.method == "GET";  // without its last slash
  if (path.empty() || path[0] != '/' || !same(path.substr(1, token_.size()), token_) ||
      (!alone && (path.size() < token_.size() + 2 || path[token_.size() + 1] != '/')))
    return Refusal{403, "the address lacks its token"};
  if (request.method == "GET") return {};
  if (request.method != "POST") return Refusal{405, "only GET and POST"};
  if (request.get_header_value("Content-Type") != "application/json" || request.has_header("Content-Encoding"))
    return Refusal{415, "only plain application/json"};
  return {};
}

std::optional<double> seconds_of(const httplib::Request& request) {
  if (!request.has_param("seconds")) return 1.0;
  const std::string text = request.get_param_value("seconds");
  const char* const last = text.data() + text.size();
  double seconds = 0.0;
  const auto [end, error] = std::from_chars(text.data(), last, seconds);
  if (error != std::errc() || end != last || !(seconds > 0.0 && seconds <= most_seconds)) return {};
  return seconds;
}

std::optional<std::size_t> number_of(const httplib::Request& request, const char* name) {
  if (!request.has_param(name)) return 0;
  const std::string text = request.get_param_value(name);
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return {};
  return number;
}

}  // namespace accdec::explore
