#include "option_checks.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>

#include <accdec/files/suggestion.hpp>

namespace accdec::cli {
namespace {

std::optional<double> finite(const std::string& text) {
  double value = 0.0;
  if (!CLI::detail::lexical_cast(text, value) || !std::isfinite(value)) return std::nullopt;
  return value;
}

/// The subcommand that was asked for, or the program itself.
const CLI::App& chosen(const CLI::App& app) {
  const auto parsed = app.get_subcommands();
  return parsed.empty() ? app : *parsed.front();
}

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

}  // namespace

std::map<std::string, double> named_numbers(const std::string& option, const std::vector<std::string>& pairs) {
  std::map<std::string, double> numbers;
  for (const std::string& pair : pairs) {
    const std::size_t equals = pair.find('=');
    const auto value = equals == std::string::npos ? std::nullopt : finite(pair.substr(equals + 1));
    if (!value) throw std::invalid_argument(fmt::format("{} takes NAME=NUMBER, got \"{}\"", option, pair));
    numbers[pair.substr(0, equals)] = *value;
  }
  return numbers;
}

CLI::Validator number_between(double low, double high) {
  return CLI::Validator(
      [low, high](std::string& text) {
        const auto value = finite(text);
        if (value && *value >= low && *value <= high) return std::string();
        return fmt::format("must be a number from {:g} to {:g}, got {}", low, high, text);
      },
      fmt::format("FLOAT in [{:g} - {:g}]", low, high));
}

CLI::Validator positive_number() {
  return CLI::Validator(
      [](std::string& text) {
        const auto value = finite(text);
        if (value && *value > 0.0 && *value <= 1e9) return std::string();
        return fmt::format("must be a number > 0 and at most 1e9, got {}", text);
      },
      "POSITIVE");
}

CLI::Validator one_of(std::vector<std::string> words) {
  const std::string all = fmt::format("{{{}}}", fmt::join(words, ","));
  return CLI::Validator(
      [words = std::move(words)](std::string& text) {
        if (std::find(words.begin(), words.end(), text) != words.end()) return std::string();
        return unknown_name("value", text, words);
      },
      all);
}

std::string usage_message(const CLI::App& app, const CLI::ParseError& error) {
  std::string message = error.what();
  const CLI::App& command = chosen(app);
  std::vector<std::string> known = option_names(command);
  if (&command != &app) {
    for (const std::string& name : option_names(app)) known.push_back(name);
  }
  const std::vector<std::string> extra = app.remaining(true);
  const auto option = std::find_if(extra.begin(), extra.end(), [](const auto& e) { return e.starts_with("--"); });
  if (option != extra.end()) {
    const std::string name = option->substr(0, option->find('='));
    message = std::find(known.begin(), known.end(), name) == known.end()
                  ? unknown_name("option", name, known)
                  : fmt::format("{} stands after \"--\", which ends the options", name);
  } else if (!extra.empty() && extra.front().starts_with("-") && extra.front().size() > 2) {
    message = fmt::format("unknown option \"{}\"; a file of this name is written ./{}, options begin with --",
                          extra.front(), extra.front());
  }
  const std::string help = &command == &app ? "accdec --help" : fmt::format("accdec {} --help", command.get_name());
  return fmt::format("{}\nRun {} for more information.", message, help);
}

}  // namespace accdec::cli
