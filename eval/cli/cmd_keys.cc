#include <fmt/format.h>

#include <iostream>

#include "eval/cli/command.h"
#include "eval/cli/table.h"
#include "eval/suite/keys.h"
#include "eval/tune/tune_config.h"
#include "world/scenario/family.h"

namespace moma::cli {
namespace {

/// "worlds" has "worlds.seed", and so has "worlds.se".
std::vector<Key> beginning_with(const std::string& prefix) {
  std::vector<Key> keys = suite_keys();
  for (Key& key : tune::tune_keys()) keys.push_back(std::move(key));
  std::erase_if(keys, [&](const Key& key) { return !key.name.starts_with(prefix); });
  return keys;
}

store::QueryResult table_of(const std::vector<Key>& keys, bool code = false) {
  const auto quoted = [&](const std::string& text) { return code && !text.empty() ? "`" + text + "`" : text; };
  store::QueryResult table{{"key", "unit", "accepted", "default", "what"}, {}};
  for (const Key& key : keys)
    table.rows.push_back({quoted(key.name), key.unit, key.accepted, quoted(key.otherwise), key.text});
  return table;
}

void print_section(std::string_view title, std::string_view text, const std::vector<Key>& keys) {
  std::cout << fmt::format("\n## {}\n", title);
  if (!text.empty()) std::cout << text << "\n";
  std::cout << '\n';
  write(std::cout, table_of(keys, true), Format::kMarkdown);
}

/// docs/reference/keys.md.
void print_reference() {
  std::cout << "# Every key\n\n"
               "Written by `scripts/reference.sh` from the descriptions that the program reads files with; `moma "
               "keys` prints the same.\n"
               "Keys are as `--set` and sweeps take them. Files of controllers and of disturbances have theirs without "
               "the first word.\n"
               "A distribution is `{uniform: [low, high]}`, `{log_uniform: [low, high]}`, `{normal: [mean, sigma]}` or "
               "`{choice: [...]}`.\n";
  std::vector<Key> suite = suite_keys();
  std::erase_if(suite, [](const Key& key) {
    return key.name.starts_with("worlds.") || key.name.starts_with("disturbances.") ||
           key.name.starts_with("controller.");
  });
  print_section("Suites", "", suite);
  std::vector<Key> worlds = beginning_with("worlds.");
  std::erase_if(worlds, [](const Key& key) { return key.name.starts_with("worlds.families."); });
  print_section("Worlds", "", worlds);
  for (const FamilyType& type : family_types()) {
    const std::string prefix = fmt::format("worlds.families.{}.", type.name);
    print_section(fmt::format("Family `{}`", type.name), fmt::format("Of every world: {}.", type.text),
                  beginning_with(prefix));
  }
  print_section(
      "Disturbances",
      "Spreads are standard deviations; \"per trial\" is drawn once for a world, \"per step\" at each control step.",
      beginning_with("disturbances."));
  print_section("Controllers", "", beginning_with("controller."));
  print_section("Tuning", "", beginning_with("tune."));
}

struct KeysOptions {
  std::string prefix;
  bool reference = false;
};

int list_keys(const KeysOptions& options) {
  if (options.reference) {
    print_reference();
    return kOk;
  }
  const std::vector<Key> keys = beginning_with(options.prefix);
  if (keys.empty()) {
    const std::string near = meant_key(options.prefix);
    throw UsageError(fmt::format("no key begins with '{}'{}", terminal_safe(options.prefix),
                                 near.empty() ? "" : fmt::format(" (did you mean {}?)", near)));
  }
  write(std::cout, table_of(keys), Format::kTable);
  return kOk;
}

}  // namespace

void add_keys(Commands& commands) {
  auto [command, options] = commands.add<KeysOptions>(
      "keys", "List every key of suites, controllers, worlds, disturbances and tuning", &list_keys);
  command.add_option("PREFIX", options.prefix, "Only keys that begin so, e.g. disturbances.objects");
  command.add_flag("--reference", options.reference, "The page docs/reference/keys.md");
  command.footer("Example: moma keys worlds.families.moving");
}

}  // namespace moma::cli
