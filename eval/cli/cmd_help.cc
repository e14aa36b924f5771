#include <fmt/format.h>

#include <iostream>

#include "eval/cli/command.h"
#include "eval/store/machine.h"

namespace moma::cli {
namespace {

/// "--help --set --seed".
std::string long_options(const CLI::App& command) {
  std::string names;
  for (const CLI::Option* option : command.get_options())
    for (const std::string& name : option->get_lnames()) names += (names.empty() ? "--" : " --") + name;
  return names;
}

/// For bash, and for zsh by its bashcompinit. Whatever is neither a command nor an option is the name of a file.
void write_bash(const CLI::App& app) {
  std::string names, options;
  for (const CLI::App* command : app.get_subcommands(nullptr)) {
    names += (names.empty() ? "" : " ") + command->get_name();
    options += fmt::format("    *:{}:-*) offered='{}' ;;\n", command->get_name(), long_options(*command));
  }
  fmt::print(
      "# Completion of moma for bash and zsh, written by: moma completion bash\n"
      "if [ -n \"${{ZSH_VERSION-}}\" ]; then autoload -U +X bashcompinit && bashcompinit; fi\n"
      "_moma() {{\n"
      "  local typed=\"${{COMP_WORDS[COMP_CWORD]}}\" offered=''\n"
      "  case \"$COMP_CWORD:${{COMP_WORDS[1]}}:$typed\" in\n"
      "    1:*:-*) offered='{}' ;;\n"
      "    1:* | *:help:*) offered='{}' ;;\n"
      "{}  esac\n"
      "  COMPREPLY=($(compgen -W \"$offered\" -- \"$typed\"))\n"
      "}}\n"
      "complete -o default -F _moma moma\n",
      long_options(app), names, options);
}

/// The text with `escape(c)` in place of each character.
template <class Escape>
std::string escaped(const std::string& text, const Escape& escape) {
  std::string out;
  for (const char c : text) out += escape(c);
  return out;
}

void write_fish(const CLI::App& app) {
  const auto quoted = [](const std::string& text) {
    return escaped(text, [](char c) { return std::string(c == '\'' || c == '\\' ? "\\" : "") + c; });
  };
  for (const CLI::App* command : app.get_subcommands(nullptr)) {
    const std::string& name = command->get_name();
    fmt::print("complete -c moma -f -n __fish_use_subcommand -a {} -d '{}'\n", name,
               quoted(command->get_description()));
    for (const CLI::Option* option : command->get_options())
      for (const std::string& word : option->get_lnames())
        fmt::print("complete -c moma -n '__fish_seen_subcommand_from {}' -l {} -d '{}'\n", name, word,
                   quoted(option->get_description()));
  }
}

/// The help of all commands; app.help() would be that of the command that was parsed.
std::string list_of_commands(const CLI::App& app) {
  return app.get_formatter()->make_help(&app, app.get_name(), CLI::AppFormatMode::Normal);
}

/// Text as it is, in the language of man(7): backslashes, hyphens that are to be typed, and lines that would be
/// requests.
std::string roff(const std::string& text) {
  char before = '\n';
  return escaped(text, [&](char c) {
    std::string out = before == '\n' && (c == '.' || c == '\'') ? "\\&" : "";
    before = c;
    return out + (c == '\\' ? "\\e" : c == '-' ? "\\-" : c == '\'' ? "\\(aq" : std::string(1, c));
  });
}

/// The manual page moma(1) in the macros of man(7): the help of every command.
std::string manual_page(const CLI::App& app) {
  std::string page = fmt::format(".TH MOMA 1 \"\" \"moma {}\" \"User Commands\"\n", store::kVersion);
  page += fmt::format(".SH NAME\nmoma \\- {}\n.SH COMMANDS\n.nf\n", roff(app.get_description()));
  page += roff(list_of_commands(app));
  for (const CLI::App* command : app.get_subcommands(nullptr))
    page += fmt::format(".SH moma {}\n{}", command->get_name(), roff(command->help("moma")));
  return page + ".fi\n";
}

}  // namespace

void add_completion(Commands& commands) {
  auto [command, shell] = commands.add<std::string>("completion", "Write the completion of command lines for a shell",
                                                    [&app = commands.app()](std::string& named) {
                                                      named == "bash" ? write_bash(app) : write_fish(app);
                                                      return kOk;
                                                    });
  command.add_option("SHELL", shell, "The shell; zsh reads bash's")->required()->check(CLI::IsMember({"bash", "fish"}));
  command.footer(
      "bash: source <(moma completion bash), in ~/.bashrc for every shell to come\n"
      "zsh:  the same, in ~/.zshrc behind compinit\n"
      "fish: moma completion fish | source, in ~/.config/fish/config.fish\n"
      "cmake --install puts them where bash and fish look for them.");
}

void add_help(Commands& commands) {
  struct Options {
    std::string command;
    bool man = false;
  };
  auto [command, options] = commands.add<Options>(
      "help", "Explain a command: its options, with an example", [&app = commands.app()](Options& o) {
        std::cout << (o.man               ? manual_page(app)
                      : o.command.empty() ? list_of_commands(app)
                                          : find_command(app, o.command).help(app.get_name()));
        return kOk;
      });
  CLI::Option* name = command.add_option("COMMAND", options.command, "Which one; all in a list without it");
  command.add_flag("--man", options.man, "The manual page, for man(1)")->excludes(name);
  command.footer("Example: moma help run");
}

}  // namespace moma::cli
