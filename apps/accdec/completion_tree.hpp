#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace accdec::cli {

/// Possible completions of a word of the command line.
struct Argument {
  std::vector<std::string> names;    ///< with their dashes; of a positional its one name
  std::string description;           ///< one line
  std::string type;                  ///< "FILE", "TASK.toml", ...: what help calls the value
  bool takes_value = false;          ///< always, of a positional
  bool repeats = false;              ///< takes several values
  std::vector<std::string> choices;  ///< words it allows; empty where it allows any
  enum class Files { none, any, folders, suffix } files = Files::none;
  std::string suffix;  ///< ".toml"
};

struct Subcommand {
  std::string name, description;
  std::vector<Argument> options, positionals;
};

/// The program's own options and its subcommands, read from what parses the command line, so that no option is written
/// down twice.
struct CommandTree {
  std::vector<Argument> options;
  std::vector<Subcommand> commands;
};
CommandTree command_tree(const CLI::App& app);

/// Completion scripts for bash, zsh and fish.
std::string bash_completion(const CommandTree& tree);
std::string zsh_completion(const CommandTree& tree);
std::string fish_completion(const CommandTree& tree);

}  // namespace accdec::cli
