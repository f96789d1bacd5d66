#pragma once

#include <map>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace accdec::cli {

/// A finite number from low to high; CLI11's own range lets "nan" pass.
CLI::Validator number_between(double low, double high);
/// A finite number above 0, up to 10^9: seconds and the like.
CLI::Validator positive_number();
/// One of these words; others get a suggestion.
CLI::Validator one_of(std::vector<std::string> words);

/// NAME=NUMBER of every text; a name given twice has its last number. @throws std::invalid_argument naming the option
std::map<std::string, double> named_numbers(const std::string& option, const std::vector<std::string>& pairs);

/// The error in a command line, with a suggestion for an unknown option.
std::string usage_message(const CLI::App& app, const CLI::ParseError& error);

}  // namespace accdec::cli
