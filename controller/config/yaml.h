#pragma once

#include <cstddef>
#include <string>

#include "controller/config/node.h"

namespace moma::config {

/// How much of the budget is used up: shared by a file and all that it includes.
struct YamlUse {
  std::size_t values = 0;
  std::size_t aliases = 0;
  std::size_t files = 0;
};

/// The one document of a YAML text, aliases copied in, `include` left as it is. `depth`: levels that enclose it.
/// Throws ConfigError: syntax, a second document, keys twice or not text, an alias inside of what it names, and
/// whatever budget.h limits.
Node read_document(const std::string& text, const std::string& name, int depth, YamlUse& use);

}  // namespace moma::config
