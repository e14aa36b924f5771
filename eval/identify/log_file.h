#pragma once

#include <filesystem>
#include <iosfwd>

#include "eval/identify/motion_log.h"

namespace moma::identify {

/// Reads a log from CSV: a head with the names of columns, then one row a control period (identify.md). Throws
/// config::ConfigError naming file, line and column: unreadable, unknown, repeated or missing columns, rows of another
/// length, anything that is not a finite number, and what check_times() refuses.
MotionLog read_log(const std::filesystem::path& file);
/// The same from text; `name` stands for the file in messages.
MotionLog parse_log(const std::string& text, const std::string& name);

/// Writes what read_log() takes back, numbers to the last bit.
void write_log(std::ostream& out, const MotionLog& log);

}  // namespace moma::identify
