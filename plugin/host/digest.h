#pragma once

#include <filesystem>
#include <string>

namespace moma {

/// What identifies a plugin: XXH3-128 of its file, 32 hex digits. Only reads: nothing of the library is loaded. Throws
/// PluginError where there is no such file.
std::string plugin_digest(const std::filesystem::path& file);

}  // namespace moma
