#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>

namespace moma::cli {

/// store::write_file() (eval/store/output_file.h) for commands. Throws UsageError.
void write_whole(const std::filesystem::path& file, const std::function<void(std::ostream&)>& write);

}  // namespace moma::cli
