#include "eval/cli/completion.h"

#include <algorithm>
#include <exception>

#include "eval/cli/completion_values.h"
#include "eval/cli/option_parts.h"

namespace moma::cli {
namespace {

/// The line in front of the cursor, followed as the program would read it.
struct TypedLine {
  std::map<std::string, std::string> positionals;
  std::size_t num_positionals = 0;
  std::vector<const CLI::Option*> given;
  const CLI::Option* waiting = nullptr;  ///< an option whose value comes next
  int values = 0;                        ///< how many
  bool only_positionals = false;         ///< behind "--"
};

/// A list without an end counts as one value: what follows may be the command's own arguments.
int num_values(const CLI::Option& option) {
  const int most = option.get_items_expected_max();
  return most > 100 ? 1 : most;
}

std::vector<const CLI::Option*> positionals_in(const CLI::App& command) {
  return command.get_options([](const CLI::Option* option) { return is_positional(*option); });
}

/// By "--long" or "-s"; nullptr where there is none.
const CLI::Option* option_named(const CLI::App& command, const std::string& word) {
  const bool is_long = word.starts_with("--");
  const std::string name = word.substr(is_long ? 2 : 1);
  for (const CLI::Option* option : command.get_options()) {
    const std::vector<std::string>& names = is_long ? option->get_lnames() : option->get_snames();
    if (std::find(names.begin(), names.end(), name) != names.end()) return option;
  }
  return nullptr;
}

void follow(const CLI::App& command, const std::string& word, TypedLine& line) {
  if (!line.only_positionals && word == "--") {
    line.only_positionals = true;
  } else if (!line.only_positionals && word.size() > 1 && word[0] == '-') {
    const std::size_t equals = word.find('=');
    line.waiting = nullptr;
    const CLI::Option* option = option_named(command, word.substr(0, equals));
    if (option == nullptr) return;
    line.given.push_back(option);
    if (wants_value(*option) && equals == std::string::npos) {
      line.waiting = option;
      line.values = num_values(*option);
    }
  } else if (line.waiting != nullptr) {
    if (--line.values == 0) line.waiting = nullptr;
  } else {
    const std::vector<const CLI::Option*> positionals = positionals_in(command);
    if (line.num_positionals < positionals.size())
      line.positionals[positionals[line.num_positionals]->get_single_name()] = word;
    ++line.num_positionals;
  }
}

/// Options that begin so, but for those that are given already and take no second value.
void offer_options(const CLI::App& command, const TypedLine& line, const std::string& partial, Completion& completion) {
  for (const CLI::Option* option : command.get_options()) {
    const bool again = std::find(line.given.begin(), line.given.end(), option) != line.given.end();
    if (again && option->get_multi_option_policy() != CLI::MultiOptionPolicy::TakeAll) continue;
    std::string name;
    for (const std::string& word : option->get_lnames()) {
      if (("--" + word).starts_with(partial)) name = "--" + word;
    }
    for (const std::string& word : option->get_snames()) {
      if (name.empty() && ("-" + word).starts_with(partial)) name = "-" + word;
    }
    if (!name.empty()) completion.candidates.push_back({name, option->get_description()});
  }
}

void complete_argument(const CLI::App& app, const CLI::App& command, const TypedLine& line, const std::string& partial,
                       Completion& completion) {
  CompletionContext context{app, line.positionals, partial};
  if (line.waiting != nullptr) {
    add_values(*line.waiting, context, completion);
  } else if (!line.only_positionals && partial.starts_with('-')) {
    const std::size_t equals = partial.find('=');
    if (equals == std::string::npos) {
      offer_options(command, line, partial, completion);
      return;
    }
    const CLI::Option* option = option_named(command, partial.substr(0, equals));
    if (option == nullptr || !wants_value(*option)) return;
    context.partial = partial.substr(equals + 1);
    add_values(*option, context, completion);
    for (Candidate& candidate : completion.candidates) candidate.text.insert(0, partial.substr(0, equals + 1));
  } else {
    const std::vector<const CLI::Option*> positionals = positionals_in(command);
    if (positionals.empty()) return;
    const CLI::Option& last = *positionals.back();
    if (line.num_positionals < positionals.size()) {
      add_values(*positionals[line.num_positionals], context, completion);
    } else if (last.get_items_expected_max() > 1) {
      add_values(last, context, completion);
    }
  }
}

}  // namespace

Completion complete(const CLI::App& app, const std::vector<std::string>& words) {
  Completion completion;
  if (words.empty()) return completion;
  const std::string& partial = words.back();
  if (words.size() == 1) {
    if (partial.starts_with('-')) {
      offer_options(app, {}, partial, completion);
    } else {
      add_command_names({app, {}, partial}, completion);
    }
    return completion;
  }
  const auto named = app.get_subcommands([&](const CLI::App* one) { return one->get_name() == words.front(); });
  if (named.empty()) return completion;
  const CLI::App* command = named.front();
  TypedLine line;
  for (std::size_t i = 1; i + 1 < words.size(); ++i) follow(*command, words[i], line);
  try {
    complete_argument(app, *command, line, partial, completion);
  } catch (const std::exception&) {
    // A store or a suite that cannot be read: a line that is not finished is no place for messages.
  }
  return completion;
}

}  // namespace moma::cli
