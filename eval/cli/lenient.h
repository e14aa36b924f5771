#pragma once

#include <filesystem>

#include "controller/config/node.h"

namespace moma::cli {

/// A robot file with `lenient` set, as --lenient asks.
config::Node lenient_robot(const std::filesystem::path& robot_file);

/// A case file whose robot is read so, be it a file of its own or a part of the case.
config::Node case_with_lenient_robot(const std::filesystem::path& case_file);

}  // namespace moma::cli
