#include "eval/cli/completion_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <filesystem>
#include <set>

#include "controller/config/node.h"
#include "eval/cli/all_keys.h"
#include "eval/cli/option_parts.h"
#include "eval/store/query.h"

namespace moma::cli {
namespace {

namespace fs = std::filesystem;

/// A list that is longer than that is shown up to the next dot of its names only.
constexpr std::size_t kMostKeys = 40;
constexpr int kMostTrials = 50;
/// A line that is being typed does not wait for a store of millions of trials.
constexpr std::chrono::seconds kPatience{2};

/// Adds what begins as typed. Words with blanks are left out: shells would take them for several.
void offer(const CompletionContext& context, Completion& completion, const std::string& text,
           const std::string& description) {
  const auto blank = [](unsigned char c) { return std::isspace(c) != 0; };
  if (text.starts_with(context.partial) && std::none_of(text.begin(), text.end(), blank))
    completion.candidates.push_back({text, description});
}

void shorten_to_the_next_dot(const CompletionContext& context, Completion& completion) {
  if (completion.candidates.size() <= kMostKeys) return;
  std::vector<Candidate> shorter;
  std::set<std::string> seen;
  for (Candidate& candidate : completion.candidates) {
    const std::size_t dot = candidate.text.find('.', context.partial.size());
    if (dot != std::string::npos) candidate = {candidate.text.substr(0, dot + 1), ""};
    if (seen.insert(candidate.text).second) shorter.push_back(candidate);
  }
  completion.candidates = std::move(shorter);
}

std::string key_description(const Key& key) {
  std::string text = key.text;
  if (!key.unit.empty()) text += fmt::format(" [{}]", key.unit);
  if (!key.otherwise.empty()) text += fmt::format(", default {}", key.otherwise);
  return text;
}

std::string argument(const CompletionContext& context, const std::string& name) {
  const auto found = context.positionals.find(name);
  return found == context.positionals.end() ? "" : found->second;
}

/// The names of a suite's controllers; none where there is no such suite.
std::vector<std::string> controllers_of(const std::string& suite) {
  std::error_code error;
  if (!fs::is_regular_file(suite, error)) return {};
  std::vector<std::string> names;
  const config::Node root = config::load_yaml(suite);
  if (const config::Node* controllers = root.find("controllers")) {
    for (const auto& entry : controllers->entries) names.push_back(entry.first);
  }
  return names;
}

/// `controllers.NAME.KEY` is the key `controller.KEY` of one of them.
constexpr std::string_view kOfAll = "controller.";
constexpr std::string_view kOfOne = "controllers.";

void add_keys_to_set(const CompletionContext& context, Completion& completion) {
  for (const Key& key : all_keys()) {
    offer(context, completion, key.name + "=", key_description(key));
    if (!context.partial.starts_with(kOfOne) || !key.name.starts_with(kOfAll)) continue;
    for (const std::string& name : controllers_of(argument(context, "SUITE"))) {
      offer(context, completion, fmt::format("{}{}.{}=", kOfOne, name, key.name.substr(kOfAll.size())),
            key_description(key));
    }
  }
  if (context.partial.starts_with(kOfOne)) {
    for (const std::string& name : controllers_of(argument(context, "SUITE")))
      offer(context, completion, fmt::format("{}{}=", kOfOne, name), "a controller of the suite, or a new one");
  }
  shorten_to_the_next_dot(context, completion);
}

/// The files in a folder beside the suite's that can be the value of `key`, as paths from here.
void add_presets(const CompletionContext& context, const std::string& key, Completion& completion) {
  std::string folder;
  if (key == "robot") folder = "robots";
  if (key == "disturbances") folder = "disturbances";
  if (key.starts_with(kOfOne) && key.find('.', kOfOne.size()) == std::string::npos) folder = "controllers";
  const std::string suite = argument(context, "SUITE");
  if (folder.empty() || suite.empty()) return;
  std::error_code error;
  std::set<std::string> files;
  const fs::path beside = (fs::path(suite).parent_path() / ".." / folder).lexically_normal();
  for (const auto& entry : fs::directory_iterator(beside, error)) {
    if (entry.path().extension() == ".yaml") files.insert(entry.path().string());
  }
  for (const std::string& file : files) offer(context, completion, key + "=" + file, "");
}

/// The words of a description such as "one of: kinematic, dynamic" or "true or false".
std::vector<std::string> accepted_words(const std::string& accepted) {
  if (accepted == "true or false") return {"true", "false"};
  constexpr std::string_view kOneOf = "one of: ";
  if (!accepted.starts_with(kOneOf)) return {};
  return CLI::detail::split_up(accepted.substr(kOneOf.size()), ',');
}

void add_settings(const CompletionContext& context, Completion& completion) {
  const std::size_t equals = context.partial.find('=');
  if (equals == std::string::npos) {
    add_keys_to_set(context, completion);
    return;
  }
  const std::string written = context.partial.substr(0, equals);
  std::string name = written;
  if (name.starts_with(kOfOne)) {
    const std::size_t dot = name.find('.', kOfOne.size());
    if (dot != std::string::npos) name = std::string(kOfAll) + name.substr(dot + 1);
  }
  for (const Key& key : all_keys()) {
    if (key.name != name) continue;
    for (const std::string& word : accepted_words(key.accepted)) {
      const std::string trimmed = CLI::detail::trim_copy(word);
      offer(context, completion, fmt::format("{}={}", written, trimmed), trimmed == key.otherwise ? "the default" : "");
    }
  }
  add_presets(context, written, completion);
}

std::string word_in(const store::Cell& cell) {
  const std::string* text = std::get_if<std::string>(&cell);
  return text == nullptr ? "" : *text;
}

/// Each row of the store's answer: a word and what describes it.
void add_rows(const CompletionContext& context, const std::string& sql, Completion& completion) {
  const std::string db = argument(context, "DB");
  const store::QueryResult found = store::query(db.empty() ? argument(context, "CASE") : db, sql, kPatience);
  for (const auto& row : found.rows) offer(context, completion, word_in(row.at(0)), word_in(row.at(1)));
}

void add_trials(const CompletionContext& context, Completion& completion) {
  std::string low = context.partial;
  const bool hex = std::all_of(low.begin(), low.end(), [](unsigned char c) { return std::isxdigit(c) != 0; });
  if (!hex || low.size() > 32) return;
  std::string high = low;
  low.resize(32, '0');
  high.resize(32, 'f');
  const auto sql = [&](const char* which) {
    return fmt::format(
        "SELECT lower(substr(hex(t.key), 1, {})), t.outcome || ', ' || w.family FROM trial AS t JOIN world AS w "
        "ON w.id = t.world_id WHERE t.key BETWEEN x'{}' AND x'{}' {} LIMIT {}",
        std::max<std::size_t>(12, context.partial.size()), low, high, which, kMostTrials);
  };
  // Before anything is typed, those that one wants to look at.
  if (context.partial.empty()) add_rows(context, sql("AND t.outcome <> 'success'"), completion);
  if (completion.candidates.empty()) add_rows(context, sql(""), completion);
}

void add_points(const CompletionContext& context, Completion& completion) {
  add_rows(context, "SELECT DISTINCT controller, '' FROM point", completion);
  add_rows(context, "SELECT DISTINCT controller || ':' || label, '' FROM point WHERE label <> ''", completion);
}

void add_suites(const CompletionContext& context, Completion& completion) {
  add_rows(context, "SELECT name, '' FROM suite ORDER BY id", completion);
}

void add_suites_to_run_again(const CompletionContext& context, Completion& completion) {
  CompletionContext of_store = context;
  of_store.positionals["DB"] = argument(context, "SUITE");
  add_suites(of_store, completion);
}

void add_queries(const CompletionContext& context, Completion& completion) {
  for (const store::NamedQuery& query : store::named_queries())
    offer(context, completion, fmt::format("@{}", query.name), std::string(query.description));
}

void add_prefixes(const CompletionContext& context, Completion& completion) {
  for (const Key& key : all_keys()) offer(context, completion, key.name, key_description(key));
  shorten_to_the_next_dot(context, completion);
}

void add_nothing(const CompletionContext& /*context*/, Completion& /*completion*/) {}

struct OwnValues {
  const char* name;
  void (*add)(const CompletionContext&, Completion&);
};
constexpr OwnValues kOwnValues[] = {
    {"set", add_settings},
    {"SQL", add_queries},
    {"TRIAL", add_trials},
    {"A", add_points},
    {"B", add_points},
    {"PREFIX", add_prefixes},
    {"COMMAND", add_command_names},
    {"suite", add_suites},
    {"rerun", add_suites_to_run_again},
    {"trials", add_nothing},
    {"seed", add_nothing},
    {"shard", add_nothing},
};

struct Endings {
  const char* name;
  std::vector<std::string> endings;
};
const std::vector<Endings>& file_endings() {
  static const std::vector<Endings> all = {
      {"SUITE", {"yaml", "db"}}, {"ROBOT", {"yaml", "urdf"}},
      {"CASE", {"json", "db"}},  {"DB", {"db"}},
      {"OUT", {"db"}},           {"IN", {"db"}},
      {"LOG", {"csv"}},
  };
  return all;
}

}  // namespace

void add_command_names(const CompletionContext& context, Completion& completion) {
  for (const CLI::App* command : context.app.get_subcommands(nullptr))
    offer(context, completion, command->get_name(), command->get_description());
}

void add_values(const CLI::Option& option, const CompletionContext& context, Completion& completion) {
  const std::string name = option.get_lnames().empty() ? option.get_single_name() : option.get_lnames().front();
  for (const OwnValues& own : kOwnValues) {
    if (name == own.name) {
      own.add(context, completion);
      return;
    }
  }
  const std::vector<std::string> words = words_accepted_by(option);
  for (const std::string& word : words) offer(context, completion, word, "");
  if (!words.empty() || !option.get_type_name().starts_with("TEXT")) return;
  completion.files = true;
  for (const Endings& known : file_endings()) {
    if (name == known.name) completion.endings = known.endings;
  }
}

std::vector<std::string> options_with_own_values() {
  std::vector<std::string> names;
  for (const OwnValues& own : kOwnValues) names.emplace_back(own.name);
  for (const Endings& known : file_endings()) names.emplace_back(known.name);
  return names;
}

}  // namespace moma::cli
