#pragma once

#include <filesystem>
#include <iosfwd>

#include "eval/identify/motion_log.h"

namespace moma::identify {

/// Reads a log from CSV: a header with the names of columns, then one row per control period (identify.md). Throws
/// config::ConfigError with file, line and column for unreadable, unknown, repeated or missing columns, rows of another
/// length, values that are not finite numbers, and errors of check_times().
MotionLog read_log(const std::filesystem::path& file);
/// Reads a log from text; `name` replaces the file's name in messages.
MotionLog parse_log(const std::string& text, const std::string& name);

/// Writes the input of read_log(), with exact numbers.
void write_log(std::ostream& out, const MotionLog& log);

}  // namespace moma::identify
