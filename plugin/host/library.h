#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>

#include "plugin/moma_plugin.h"

namespace moma {

/// Why a plugin cannot be used; what() does not repeat the file's name.
class PluginError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The functions of a plugin in this process.
struct PluginFunctions {
  std::function<std::remove_pointer_t<decltype(&moma_plugin_open)>> open;
  decltype(&moma_plugin_close) close = nullptr;
  decltype(&moma_plugin_start) start = nullptr;
  decltype(&moma_plugin_step) step = nullptr;
  decltype(&moma_plugin_stop) stop = nullptr;
};

/// A shared library that was loaded for its controller. It stays in the process for good: threads and destructors of
/// its own may outlive any controller.
struct PluginLibrary {
  std::filesystem::path file;  ///< absolute
  std::string digest;          ///< XXH3-128 of the file, 32 hex digits
  PluginFunctions functions;
};

/// Loads a library and checks it: readable, a shared library, all functions there, made for this MOMA_PLUGIN_ABI, and
/// the code at work that of the file (a library rebuilt while the process holds the former one is refused). Throws
/// PluginError. What a library does while it is loaded is out of our hands.
std::shared_ptr<const PluginLibrary> load_plugin(const std::filesystem::path& file);

/// What identifies a plugin: XXH3-128 of its file, 32 hex digits. Only reads: nothing of the library is loaded. Throws
/// PluginError where there is no such file.
std::string plugin_digest(const std::filesystem::path& file);

}  // namespace moma
