#include "completion_tree.hpp"

#include <algorithm>

namespace accdec::cli {
namespace {

/// The words of "TEXT:{exact,nlp}".
std::vector<std::string> choices_in(const std::string& type) {
  const std::size_t open = type.find('{'), close = type.find('}', open);
  if (open == std::string::npos || close == std::string::npos) return {};
  return CLI::detail::split(type.substr(open + 1, close - open - 1), ',');
}

Argument argument_of(const CLI::Option& option) {
  Argument argument;
  if (option.get_positional()) {
    argument.names.push_back(option.get_name(true));
  } else {
    for (const std::string& name : option.get_snames()) argument.names.push_back("-" + name);
    for (const std::string& name : option.get_lnames()) argument.names.push_back("--" + name);
  }
  argument.description = option.get_description();
  std::replace(argument.description.begin(), argument.description.end(), '\n', ' ');
  argument.takes_value = option.get_items_expected_max() > 0;
  argument.repeats = option.get_items_expected_max() > 1;
  const std::string type = option.get_type_name();
  argument.choices = choices_in(type);
  argument.type = type.substr(0, type.find_first_of(":. "));
  if (type.starts_with("FILE")) {
    argument.files = Argument::Files::any;
  } else if (type.starts_with("DIR")) {
    argument.files = Argument::Files::folders;
  } else if (const std::size_t dot = type.find('.'); dot != std::string::npos && dot > 0 && type.size() > dot + 1 &&
                                                     std::isalpha(static_cast<unsigned char>(type[dot + 1])) != 0) {
    argument.files = Argument::Files::suffix;
    argument.suffix = type.substr(dot, type.find_first_of(".: ", dot + 1) - dot);
  }
  return argument;
}

void add_arguments(const CLI::App& app, std::vector<Argument>& options, std::vector<Argument>* positionals) {
  for (const CLI::Option* option : app.get_options([](const CLI::Option* o) { return !o->get_group().empty(); })) {
    if (option->get_positional() && positionals != nullptr) {
      positionals->push_back(argument_of(*option));
    } else if (!option->get_positional()) {
      options.push_back(argument_of(*option));
    }
  }
}

}  // namespace

CommandTree command_tree(const CLI::App& app) {
  CommandTree tree;
  add_arguments(app, tree.options, nullptr);
  for (const CLI::App* command : app.get_subcommands([](const CLI::App* c) { return !c->get_group().empty(); })) {
    Subcommand subcommand{command->get_name(), command->get_description(), {}, {}};
    add_arguments(*command, subcommand.options, &subcommand.positionals);
    tree.commands.push_back(std::move(subcommand));
  }
  return tree;
}

}  // namespace accdec::cli
