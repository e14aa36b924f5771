#pragma once

#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>

#include "controller/config/paths.h"
#include "plugin/moma_plugin.h"

namespace moma {

/// An unusable plugin; what() does not repeat the file's name.
class PluginError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The text with a blank for each control character.
std::string without_controls(std::string text);

/// The functions of a plugin in this process.
struct PluginFunctions {
  std::function<std::remove_pointer_t<decltype(&moma_plugin_open)>> open;
  decltype(&moma_plugin_close) close = nullptr;
  decltype(&moma_plugin_start) start = nullptr;
  decltype(&moma_plugin_step) step = nullptr;
  decltype(&moma_plugin_stop) stop = nullptr;
};

/// A loaded shared library. It stays in the process for good: its threads and destructors may outlive any controller.
struct PluginLibrary {
  fs::path file;       ///< absolute
  std::string digest;  ///< XXH3-128 of the file, 32 hex digits
  PluginFunctions functions;
};

/// Loads a library and checks it: readable, a shared library, all functions there, made for this MOMA_PLUGIN_ABI, not
/// rebuilt since the process loaded it. Throws PluginError.
std::shared_ptr<const PluginLibrary> load_plugin(const fs::path& file);

/// Returns the digest that identifies a plugin, without loading it. Throws PluginError if there is no such file.
std::string plugin_digest(const fs::path& file);

}  // namespace moma
