#include <memory>
#include <string>

#include <fmt/format.h>

#include "command.hpp"
#include "completion_tree.hpp"
#include "option_checks.hpp"

namespace accdec::cli {

void add_completion(CLI::App& app, Context&) {
  auto shell = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand(
      "completion", "Print the completion of this command line for a shell: source <(accdec completion bash)");
  command->add_option("shell", *shell, "bash, zsh or fish")->required()->check(one_of({"bash", "zsh", "fish"}));
  command->callback([shell, &app] {
    const CommandTree tree = command_tree(app);
    fmt::print("{}", *shell == "bash"  ? bash_completion(tree)
                     : *shell == "zsh" ? zsh_completion(tree)
                                       : fish_completion(tree));
  });
}

}  // namespace accdec::cli
