#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "completion_tree.hpp"

namespace accdec::cli {
namespace {

using Files = Argument::Files;

std::string joined(const std::vector<Argument>& options) {
  std::vector<std::string> names;
  for (const Argument& option : options) names.insert(names.end(), option.names.begin(), option.names.end());
  return fmt::format("{}", fmt::join(names, " "));
}

std::string replaced(std::string text, std::string_view what, std::string_view with) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += with.size())
    text.replace(at, what.size(), with);
  return text;
}

/// The command that lists what a value may be, in bash.
std::string bash_values(const Argument& argument) {
  if (!argument.choices.empty()) return fmt::format("_accdec_words \"{}\"", fmt::join(argument.choices, " "));
  switch (argument.files) {
    case Files::any: return "_accdec_files";
    case Files::folders: return "_accdec_folders";
    case Files::suffix: return fmt::format("_accdec_files \"{}\"", argument.suffix);
    case Files::none: break;
  }
  return ":";
}

/// Inside single quotes of zsh, in a specification of _arguments.
std::string zsh_quoted(std::string text) {
  for (const auto& [what, with] : {std::pair{"\\", "\\\\"}, {"[", "\\["}, {"]", "\\]"}, {":", "\\:"}, {"'", "'\\''"}})
    text = replaced(std::move(text), what, with);
  return text;
}

std::string zsh_values(const Argument& argument) {
  const std::string type = zsh_quoted(argument.type);
  if (!argument.choices.empty()) return fmt::format(":{}:({})", type, fmt::join(argument.choices, " "));
  switch (argument.files) {
    case Files::any: return fmt::format(":{}:_files", type);
    case Files::folders: return fmt::format(":{}:_files -/", type);
    case Files::suffix: return fmt::format(":{}:_files -g \"*{}\"", type, argument.suffix);
    case Files::none: break;
  }
  return fmt::format(":{}: ", type);
}

std::string zsh_arguments(const std::vector<Argument>& options, const std::vector<Argument>& positionals,
                          std::string_view indent) {
  std::string text;
  for (const Argument& option : options) {
    const std::string description =
        fmt::format("[{}]{}", zsh_quoted(option.description), option.takes_value ? zsh_values(option) : "");
    for (const std::string& name : option.names) {
      const std::string once = option.repeats ? "*" : fmt::format("({})", fmt::join(option.names, " "));
      text += fmt::format(" \\\n{}'{}{}{}'", indent, once, name, description);
    }
  }
  for (std::size_t i = 0; i < positionals.size(); ++i) {
    const std::string place = positionals[i].repeats ? "*" : std::to_string(i + 1);
    text += fmt::format(" \\\n{}'{}{}'", indent, place, zsh_values(positionals[i]));
  }
  return text;
}

std::string fish_quoted(std::string text) {
  return "'" + replaced(replaced(std::move(text), "\\", "\\\\"), "'", "\\'") + "'";
}

std::string fish_values(const Argument& argument) {
  if (!argument.choices.empty()) return fmt::format(" -a '{}'", fmt::join(argument.choices, " "));
  switch (argument.files) {
    case Files::any: return " -F";
    case Files::folders: return " -a '(__fish_complete_directories)'";
    case Files::suffix: return fmt::format(" -a '(__fish_complete_suffix {})'", argument.suffix);
    case Files::none: break;
  }
  return "";
}

std::string fish_option(const Argument& option, const std::string& condition) {
  std::string line = "complete -c accdec" + condition;
  for (const std::string& name : option.names)
    line += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
  if (option.takes_value) line += (option.files == Files::any ? " -r" : " -x") + fish_values(option);
  return line + " -d " + fish_quoted(option.description) + "\n";
}

}  // namespace

std::string bash_completion(const CommandTree& tree) {
  std::vector<std::string> names;
  for (const Subcommand& command : tree.commands) names.push_back(command.name);
  std::string options, values, words;
  for (const Subcommand& command : tree.commands) {
    options += fmt::format("    {}) options=\"{}\" ;;\n", command.name, joined(command.options));
    for (const Argument& option : command.options) {
      if (!option.takes_value) continue;
      for (const std::string& name : option.names)
        values += fmt::format("    \"{} {}\") {}; return ;;\n", command.name, name, bash_values(option));
    }
    if (!command.positionals.empty())
      words += fmt::format("    {}) {} ;;\n", command.name, bash_values(command.positionals.front()));
  }
  return fmt::format(R"(# bash completion for accdec, made by `accdec completion bash`.
_accdec_words() {{ mapfile -t COMPREPLY < <(compgen -W "$1" -- "$cur"); }}
_accdec_folders() {{ compopt -o filenames 2>/dev/null; mapfile -t COMPREPLY < <(compgen -d -- "$cur"); }}
_accdec_files() {{
  compopt -o filenames 2>/dev/null
  mapfile -t COMPREPLY < <(compgen -d -- "$cur"; compgen -f -X "!*${{1:-}}" -- "$cur")
  mapfile -t COMPREPLY < <(printf '%s\n' "${{COMPREPLY[@]}}" | sort -u)
  [ -n "${{COMPREPLY[0]:-}}" ] || COMPREPLY=()
}}
_accdec() {{
  local cur=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD-1]}} command="" word options="{0}"
  COMPREPLY=()
  for word in "${{COMP_WORDS[@]:1:COMP_CWORD-1}}"; do
    case $word in
    {1}) command=$word; break ;;
    esac
  done
  case $command in
    "") ;;
{2}  esac
  case "$command $before" in
{3}  esac
  case $cur in
    -*) _accdec_words "$options"; return ;;
  esac
  case $command in
    "") _accdec_words "{4}" ;;
{5}  esac
}}
complete -F _accdec accdec
)",
                     joined(tree.options), fmt::join(names, "|"), options, values, fmt::join(names, " "), words);
}

std::string zsh_completion(const CommandTree& tree) {
  std::string commands, cases;
  for (const Subcommand& command : tree.commands) {
    commands += fmt::format("        '{}:{}'\n", command.name, zsh_quoted(command.description));
    cases += fmt::format("        {})\n          _arguments -s{} ;;\n", command.name,
                         zsh_arguments(command.options, command.positionals, "            "));
  }
  return fmt::format(R"(#compdef accdec
# zsh completion for accdec, made by `accdec completion zsh`.
_accdec() {{
  local curcontext=$curcontext state line
  local -a commands
  _arguments -C -s{} \
    '1: :->command' \
    '*:: :->rest'
  case $state in
    command)
      commands=(
{}      )
      _describe -t commands 'accdec command' commands ;;
    rest)
      case $words[1] in
{}      esac ;;
  esac
}}
_accdec "$@"
)",
                     zsh_arguments(tree.options, {}, "    "), commands, cases);
}

std::string fish_completion(const CommandTree& tree) {
  std::string text = "# fish completion for accdec, made by `accdec completion fish`.\ncomplete -c accdec -f\n";
  for (const Argument& option : tree.options) text += fish_option(option, " -n __fish_use_subcommand");
  for (const Subcommand& command : tree.commands) {
    text += fmt::format("complete -c accdec -n __fish_use_subcommand -a {} -d {}\n", command.name,
                        fish_quoted(command.description));
  }
  for (const Subcommand& command : tree.commands) {
    const std::string condition = fmt::format(" -n '__fish_seen_subcommand_from {}'", command.name);
    for (const Argument& option : command.options) text += fish_option(option, condition);
    for (const Argument& positional : command.positionals) {
      const std::string values = fish_values(positional);
      if (!values.empty()) text += fmt::format("complete -c accdec{}{}\n", condition, values);
    }
  }
  return text;
}

}  // namespace accdec::cli
