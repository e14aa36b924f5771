#include <fmt/format.h>

#include <iostream>
#include <memory>

#include "eval/cli/command.h"

namespace moma::cli {
namespace {

/// "--help --set --seed".
std::string long_options(const CLI::App& command) {
  std::string names;
  for (const CLI::Option* option : command.get_options())
    for (const std::string& name : option->get_lnames()) names += (names.empty() ? "--" : " --") + name;
  return names;
}

std::string commands_of(const CLI::App& app) {
  std::string names;
  for (const CLI::App* command : app.get_subcommands(nullptr))
    names += (names.empty() ? "" : " ") + command->get_name();
  return names;
}

/// For bash, and for zsh by its bashcompinit. Whatever is neither a command nor an option is the name of a file.
void write_bash(const CLI::App& app) {
  fmt::print(
      "# Completion of moma for bash and zsh, written by: moma completion bash\n"
      "if [ -n \"${{ZSH_VERSION-}}\" ]; then autoload -U +X bashcompinit && bashcompinit; fi\n"
      "_moma() {{\n"
      "  local typed=\"${{COMP_WORDS[COMP_CWORD]}}\" offered=''\n"
      "  case \"$COMP_CWORD:${{COMP_WORDS[1]}}:$typed\" in\n"
      "    1:*:-*) offered='{}' ;;\n"
      "    1:* | *:help:*) offered='{}' ;;\n",
      long_options(app), commands_of(app));
  for (const CLI::App* command : app.get_subcommands(nullptr))
    fmt::print("    *:{}:-*) offered='{}' ;;\n", command->get_name(), long_options(*command));
  fmt::print(
      "  esac\n"
      "  COMPREPLY=($(compgen -W \"$offered\" -- \"$typed\"))\n"
      "}}\n"
      "complete -o default -F _moma moma\n");
}

std::string in_quotes(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' || c == '\\' ? std::string("\\") + c : std::string(1, c);
  return quoted + "'";
}

void write_fish(const CLI::App& app) {
  for (const CLI::App* command : app.get_subcommands(nullptr)) {
    const std::string& name = command->get_name();
    fmt::print("complete -c moma -f -n __fish_use_subcommand -a {} -d {}\n", name,
               in_quotes(command->get_description()));
    for (const CLI::Option* option : command->get_options())
      for (const std::string& word : option->get_lnames())
        fmt::print("complete -c moma -n '__fish_seen_subcommand_from {}' -l {} -d {}\n", name, word,
                   in_quotes(option->get_description()));
  }
}

}  // namespace

void add_completion(CLI::App& app, Action& action, const Arguments& /*arguments*/) {
  auto shell = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand("completion", "Write the completion of command lines for a shell");
  command->add_option("SHELL", *shell, "The shell; zsh reads bash's")
      ->required()
      ->check(CLI::IsMember({"bash", "fish"}));
  command->footer(
      "bash: source <(moma completion bash), in ~/.bashrc for every shell to come\n"
      "zsh:  the same, in ~/.zshrc behind compinit\n"
      "fish: moma completion fish | source, in ~/.config/fish/config.fish\n"
      "cmake --install puts them where bash and fish look for them.");
  command->callback([&app, &action, shell] {
    action = [&app, shell] {
      *shell == "bash" ? write_bash(app) : write_fish(app);
      return static_cast<int>(kOk);
    };
  });
}

}  // namespace moma::cli
