#include "plugin/process/command.h"

namespace moma {

extern const char* const kPythonRunner;  // runner.py, by CMake

ProcessCommand python_command(const std::string& interpreter, const std::filesystem::path& file,
                              const std::string& class_name) {
  ProcessCommand command;
  command.arguments = {interpreter, "-c", kPythonRunner, file.string(), class_name};
  command.directory = file.parent_path();
  command.environment = {"PYTHONHASHSEED=0",  "PYTHONDONTWRITEBYTECODE=1", "PYTHONIOENCODING=utf-8",
                         "OMP_NUM_THREADS=1", "OPENBLAS_NUM_THREADS=1",    "MKL_NUM_THREADS=1"};
  command.files = {file};
  return command;
}

}  // namespace moma
