#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <memory>
#include <set>
#include <vector>

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

bool is_positional(const CLI::Option& option) { return !option.nonpositional(); }

/// "a,b" of a type such as "TEXT:{a,b}"; "" of others.
std::string words_of_type(const std::string& type) {
  const std::size_t open = type.find('{');
  const std::size_t close = type.find('}');
  return open == std::string::npos || close == std::string::npos || close < open
             ? ""
             : type.substr(open + 1, close - open - 1);
}

/// "DB", "-o, --output".
std::string option_names(const CLI::Option& option) {
  if (is_positional(option)) return option.get_single_name();
  std::string names;
  for (const std::string& name : option.get_snames()) names += (names.empty() ? "-" : ", -") + name;
  for (const std::string& name : option.get_lnames()) names += (names.empty() ? "--" : ", --") + name;
  return names;
}

/// "TEXT", "INT in [1 - 4096]", "sphere|capsule|box"; "" of a flag.
std::string option_value(const CLI::Option& option) {
  if (option.get_items_expected_max() == 0) return "";
  if (!option.get_option_text().empty()) return option.get_option_text();
  const std::string type = option.get_type_name();
  if (std::string words = words_of_type(type); !words.empty()) {
    std::replace(words.begin(), words.end(), ',', '|');
    return words;
  }
  const std::size_t colon = type.find(':');
  if (colon == std::string::npos) return type;
  const std::string checked = type.substr(colon + 1);
  const std::string kind = type.substr(0, colon);
  return checked.starts_with("INT in") || checked.starts_with("FLOAT in") || checked.starts_with("UINT in")
             ? kind + checked.substr(checked.find(" in"))
             : kind + " " + checked;
}

std::string joined_names(const std::set<CLI::Option*>& options) {
  std::vector<std::string> names;
  for (const CLI::Option* option : options)
    names.push_back((is_positional(*option) ? "" : "--") + option->get_single_name());
  std::sort(names.begin(), names.end());
  return fmt::format("{}", fmt::join(names, ", "));
}

/// The description with what the option's own text leaves out.
std::string option_text(const CLI::Option& option) {
  std::string text = option.get_description();
  if (!option.get_default_str().empty()) text += fmt::format(" ({})", option.get_default_str());
  if (!option.get_needs().empty()) text += fmt::format("; with {} only", joined_names(option.get_needs()));
  if (!option.get_excludes().empty()) text += fmt::format("; not with {}", joined_names(option.get_excludes()));
  return text;
}

/// "moma run [OPTIONS] SUITE", "moma merge [OPTIONS] OUT IN...".
std::string usage_of(const CLI::App& command) {
  std::string usage = fmt::format("moma {} [OPTIONS]", command.get_name());
  for (const CLI::Option* option : command.get_options()) {
    if (!is_positional(*option)) continue;
    const std::string name = option->get_single_name() + (option->get_items_expected_max() > 1 ? "..." : "");
    usage += option->get_required() ? " " + name : " [" + name + "]";
  }
  return usage;
}

/// Text as it is, in the language of man(7): backslashes, hyphens that are to be typed, and lines that would be
/// requests.
std::string roff(const std::string& text) {
  std::string out;
  bool begins = true;
  for (const char c : text) {
    if (begins && (c == '.' || c == '\'')) out += "\\&";
    begins = c == '\n';
    out += c == '\\' ? "\\e" : c == '-' ? "\\-" : c == '\'' ? "\\(aq" : std::string(1, c);
  }
  return out;
}

std::string markdown_cell(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '|' ? std::string("\\|") : std::string(1, c);
  return out;
}

/// The manual page moma(1) in the macros of man(7): the help of every command.
std::string manual_page(const CLI::App& app) {
  std::string page = fmt::format(".TH MOMA 1 \"\" \"moma {}\" \"User Commands\"\n", store::kVersion);
  page += fmt::format(".SH NAME\nmoma \\- {}\n.SH COMMANDS\n.nf\n", roff(app.get_description()));
  page += roff(app.get_formatter()->make_help(&app, "moma", CLI::AppFormatMode::Normal));
  for (const CLI::App* command : app.get_subcommands(nullptr))
    page += fmt::format(".SH moma {}\n{}", command->get_name(), roff(command->help("moma")));
  return page + ".fi\n";
}

/// docs/reference/commands.md.
std::string commands_page(const CLI::App& app) {
  std::string page =
      "# Every command\n\n"
      "Written by `scripts/reference.sh` from the program's own descriptions. `moma help COMMAND`, `moma COMMAND "
      "--help` and the manual page say the same.\n\n| command | what it does |\n| --- | --- |\n";
  for (const CLI::App* command : app.get_subcommands(nullptr))
    page +=
        fmt::format("| [`{0}`](#moma-{0}) | {1} |\n", command->get_name(), markdown_cell(command->get_description()));
  page += fmt::format("\n```text\n{}\n```\n", app.get_footer());
  for (const CLI::App* command : app.get_subcommands(nullptr)) {
    page += fmt::format("\n## moma {}\n\n{}.\n\n```text\n{}\n```\n\n| option | value | what |\n| --- | --- | --- |\n",
                        command->get_name(), command->get_description(), usage_of(*command));
    for (const CLI::Option* option : command->get_options()) {
      const std::string value = option_value(*option);
      page += fmt::format("| `{}` | {} | {} |\n", option_names(*option),
                          markdown_cell(value.empty() ? "" : "`" + value + "`"), markdown_cell(option_text(*option)));
    }
    if (!command->get_footer().empty()) page += fmt::format("\n```text\n{}\n```\n", command->get_footer());
  }
  return page;
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

void add_help(CLI::App& app, Action& action, const Arguments& /*arguments*/) {
  struct Options {
    std::string command;
    bool man = false;
    bool reference = false;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("help", "Explain a command: its options, with an example");
  CLI::Option* name = command->add_option("COMMAND", options->command, "Which one; all in a list without it");
  CLI::Option* man = command->add_flag("--man", options->man, "The manual page, for man(1)")->excludes(name);
  command->add_flag("--reference", options->reference, "The page docs/reference/commands.md")
      ->excludes(name)
      ->excludes(man);
  command->footer("Example: moma help run");
  command->callback([&app, &action, options] {
    action = [&app, options] {
      if (options->man) {
        std::cout << manual_page(app);
      } else if (options->reference) {
        std::cout << commands_page(app);
      } else if (options->command.empty()) {
        // app.help() would be that of the command that was parsed: of this one.
        std::cout << app.get_formatter()->make_help(&app, app.get_name(), CLI::AppFormatMode::Normal);
      } else {
        std::cout << find_command(app, options->command).help(app.get_name());
      }
      return static_cast<int>(kOk);
    };
  });
}

}  // namespace moma::cli
