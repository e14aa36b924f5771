#pragma once

#include <string>

#include "controller/config/node.h"
#include "eval/suite/controller_entry.h"

namespace moma {

/// Code that a controller's entry names, where the entry comes from a store: what was stored is a stranger's until the
/// user says otherwise.
struct StoredCode {
  config::Mark mark;   ///< where it is named, for messages
  std::string key;     ///< "controllers.mine.path"
  std::string name;    ///< as it is named
  std::string digest;  ///< that it has to have; "" where none is stated
  bool absolute = false;
};

/// Throws PluginRefused where nobody allowed it, config::ConfigError where it is not named by absolute paths and
/// digest.
void check_stored(const StoredCode& code, Plugins plugins);

/// Throws PluginError unless `found` is what was wanted.
void check_digest(const std::string& found, const std::string& wanted);

}  // namespace moma
