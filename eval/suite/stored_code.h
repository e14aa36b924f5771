#pragma once

#include <string>

#include "controller/config/node.h"
#include "eval/suite/controller_entry.h"

namespace moma {

/// Code that a stored controller entry names. Stored code is untrusted until the user allows it.
struct StoredCode {
  config::Mark mark;   ///< place of the name, for messages
  std::string key;     ///< "controllers.mine.path"
  std::string name;    ///< the name itself
  std::string digest;  ///< required digest; "" if none is stated
  bool absolute = false;
};

/// Throws PluginRefused without permission, config::ConfigError without absolute paths and digest.
void check_stored(const StoredCode& code, Plugins plugins);

/// Throws PluginError unless `found` equals `wanted`.
void check_digest(const std::string& found, const std::string& wanted);

}  // namespace moma
