#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>

namespace moma::cli {

/// Writes a file whole or not at all: `write` fills FILE.part, which then takes its place. Throws UsageError.
void write_whole(const std::filesystem::path& file, const std::function<void(std::ostream&)>& write);

}  // namespace moma::cli
