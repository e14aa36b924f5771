#include "eval/cli/whole_file.h"

#include "eval/cli/command.h"
#include "eval/store/output_file.h"

namespace moma::cli {

void write_whole(const std::filesystem::path& file, const std::function<void(std::ostream&)>& write) {
  try {
    store::write_file(file, write);
  } catch (const store::OutputError& error) {
    throw UsageError(error.what());
  }
}

}  // namespace moma::cli
