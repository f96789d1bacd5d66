#pragma once

#include <algorithm>
#include <climits>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <accdec/files/suggestion.hpp>
#include <accdec/machine.hpp>

namespace accdec {

/// An error and its place, before its position in the text is known.
struct Mistake {
  std::string pointer, message;
};

/// A member or element with its path, for errors that name the place. The JSON kind is ordered: members keep the order
/// of the file, so text that is written again looks the same.
class Value {
 public:
  using Json = nlohmann::ordered_json;
  Value(const Json& json, std::string pointer) : json_(json), pointer_(std::move(pointer)) {}

  [[noreturn]] void fail(const std::string& message) const { throw Mistake{pointer_, message}; }
  [[noreturn]] void wrong_type(std::string_view wanted) const {
    fail(fmt::format("must be {}, got {}", wanted, json_.type_name()));
  }

  /// Checks the members of an object. Those after `required` may be missing.
  void members(std::initializer_list<std::string_view> required,
               std::initializer_list<std::string_view> optional = {}) const {
    if (!json_.is_object()) wrong_type("an object");
    std::vector<std::string_view> known(required);
    known.insert(known.end(), optional);
    for (const auto& [key, value] : json_.items()) {
      if (std::find(known.begin(), known.end(), key) == known.end()) {
        throw Mistake{pointer_ + "/" + key, fmt::format("unknown member; {}", suggest(key, known))};
      }
    }
    for (const std::string_view key : required) {
      if (!json_.contains(key)) fail(fmt::format("lacks the member `{}`", key));
    }
  }
  bool has(std::string_view key) const { return json_.contains(key) && !json_.at(std::string(key)).is_null(); }
  Value operator[](std::string_view key) const {
    if (!json_.is_object()) wrong_type("an object");
    const auto found = json_.find(std::string(key));
    if (found == json_.end()) fail(fmt::format("lacks the member `{}`", key));
    return {*found, fmt::format("{}/{}", pointer_, key)};
  }
  std::vector<Value> elements() const {
    if (!json_.is_array()) wrong_type("an array");
    std::vector<Value> values;
    for (std::size_t i = 0; i < json_.size(); ++i) values.emplace_back(json_[i], fmt::format("{}/{}", pointer_, i));
    return values;
  }
  /// Lists may be long: an element gets its path only where it is wrong.
  std::vector<double> numbers() const {
    return list<double>([](const Json& json) { return json.is_number(); },
                        [](const Value& value) { return value.number(); });
  }
  /// null stands for infinity.
  std::vector<double> numbers_or_infinity() const {
    return list<double>([](const Json& json) { return json.is_number(); },
                        [](const Value& value) { return value.number_or_infinity(); });
  }
  template <class Integer>
  std::vector<Integer> integers() const {
    constexpr long small = 100;  // in every type
    return list<Integer>(
        [](const Json& json) { return json.is_number_unsigned() && json.get<unsigned long>() <= small; },
        [](const Value& value) { return value.template integer<Integer>(); });
  }
  std::string text() const {
    if (!json_.is_string()) wrong_type("a string");
    return json_.get<std::string>();
  }
  bool boolean() const {
    if (!json_.is_boolean()) wrong_type("true or false");
    return json_.get<bool>();
  }
  double number() const {
    if (!json_.is_number()) wrong_type("a number");
    return json_.get<double>();
  }
  /// null stands for infinity.
  double number_or_infinity() const { return json_.is_null() ? unlimited : number(); }
  std::optional<double> optional_number() const { return json_.is_null() ? std::nullopt : std::optional(number()); }
  long integer(long low, long high) const {
    if (!json_.is_number_integer()) wrong_type("a whole number");
    const double x = json_.get<double>();  // numbers beyond 64 bits must not wrap around
    if (x < static_cast<double>(low) || x > static_cast<double>(high))
      fail(fmt::format("{} is out of range; allowed is {} .. {}", x, low, high));
    return json_.get<long>();
  }
  /// Any whole number that is not negative and that the type holds.
  template <class Integer>
  Integer integer() const {
    constexpr auto most =
        static_cast<long>(std::min<std::uintmax_t>(std::numeric_limits<Integer>::max(), LONG_MAX / 2));
    return static_cast<Integer>(integer(0, most));
  }
  /// The enumerator whose `to_string` is the text.
  template <class Enum>
  Enum word(std::initializer_list<Enum> all) const {
    return word(std::span<const Enum>(all.begin(), all.size()));
  }
  template <class Enum>
  Enum word(std::span<const Enum> all) const {
    const std::string given = text();
    std::string known;
    for (const Enum e : all) {
      if (to_string(e) == given) return e;
      known += (known.empty() ? "" : ", ") + std::string(to_string(e));
    }
    fail(fmt::format("\"{}\" is unknown; allowed are {}", given, known));
  }
  const Json& json() const { return json_; }
  const std::string& pointer() const { return pointer_; }

 private:
  /// @param plain  whether a JSON value is the number itself
  template <class Number, class Plain, class Read>
  std::vector<Number> list(const Plain& plain, const Read& read) const {
    if (!json_.is_array()) wrong_type("an array");
    std::vector<Number> values;
    values.reserve(json_.size());
    for (std::size_t i = 0; i < json_.size(); ++i) {
      values.push_back(plain(json_[i]) ? json_[i].get<Number>()
                                       : read(Value(json_[i], fmt::format("{}/{}", pointer_, i))));
    }
    return values;
  }

  const Json& json_;
  std::string pointer_;
};

}  // namespace accdec
