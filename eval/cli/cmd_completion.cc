#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <memory>

#include "eval/cli/command.h"
#include "eval/cli/completion.h"
#include "eval/cli/table.h"

namespace moma::cli {

// Written by CMake from completion/.
extern const char* const kBashCompletion;
extern const char* const kZshCompletion;
extern const char* const kFishCompletion;

namespace {

/// One candidate a line, a tab, what describes it; ":files" with the endings where files can stand there.
void print_completion(const Completion& completion) {
  for (const Candidate& candidate : completion.candidates)
    std::cout << terminal_safe(candidate.text) << '\t' << terminal_safe(candidate.description) << '\n';
  if (completion.files) std::cout << fmt::format(":files\t{}\n", fmt::join(completion.endings, " "));
}

/// What stands behind the first "--", as it was typed.
std::vector<std::string> words_behind_dashes(const Arguments& arguments) {
  const auto dashes = std::find(arguments.begin(), arguments.end(), "--");
  return dashes == arguments.end() ? std::vector<std::string>{} : std::vector<std::string>(dashes + 1, arguments.end());
}

}  // namespace

void add_completion(CLI::App& app, Action& action, const Arguments& arguments) {
  struct Options {
    std::string shell;
    std::vector<std::string> words;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("completion", "Write the completion of command lines for a shell");
  command->add_option("SHELL", options->shell, "The shell; words: for scripts, what can follow on a line")
      ->required()
      ->check(CLI::IsMember({"bash", "zsh", "fish", "words"}));
  command->add_option("WORDS", options->words, "With words: -- and the line so far, without the program");
  command->footer(
      "bash: source <(moma completion bash), in ~/.bashrc for every shell to come\n"
      "zsh:  source <(moma completion zsh), in ~/.zshrc behind compinit\n"
      "fish: moma completion fish | source, in ~/.config/fish/config.fish\n"
      "cmake --install puts all three where the shells look for them.\n"
      "Example: moma completion words -- run configs/suites/demo.yaml --set simulation.");
  command->callback([&app, &action, options, &arguments] {
    action = [&app, options, &arguments] {
      if (options->shell == "words") {
        print_completion(complete(app, words_behind_dashes(arguments)));
        return static_cast<int>(kOk);
      }
      if (!options->words.empty())
        throw UsageError(fmt::format("completion: one argument too many: '{}'; see moma completion --help",
                                     terminal_safe(options->words.front())));
      std::cout << (options->shell == "bash"  ? kBashCompletion
                    : options->shell == "zsh" ? kZshCompletion
                                              : kFishCompletion);
      return static_cast<int>(kOk);
    };
  });
}

}  // namespace moma::cli
