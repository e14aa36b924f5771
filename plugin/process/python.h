#pragma once

#include <filesystem>
#include <string>

#include "plugin/process/command.h"

namespace moma {

/// The command that runs a class of a Python file (docs/how-to/python-controller.md): `interpreter` with moma's runner.
/// What could make two runs differ is set in its environment: the order of sets, the threads of linear algebra.
/// `files` and `limits` are the caller's to fill in.
ProcessCommand python_command(const std::string& interpreter, const std::filesystem::path& file,
                              const std::string& class_name);

}  // namespace moma
