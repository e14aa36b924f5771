// Suites; paths in them start at a folder whose `configs` and `tests` are the source's.
#include "eval/suite/suite.h"

#include <stdlib.h>

#include <fstream>
#include <stdexcept>

#include "tests/fuzz/target.h"

namespace {

namespace fs = std::filesystem;

/// Gone at the end, like what is in it.
class Folder {
 public:
  Folder() {
    std::string name = (fs::temp_directory_path() / "moma-fuzz-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path_ = name;
    for (const char* part : {"configs", "tests"}) fs::create_directory_symlink(fs::current_path() / part, path_ / part);
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  fs::path file() const { return path_ / "fuzz.yaml"; }

 private:
  fs::path path_;
};

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace moma;
  static const Folder kFolder;
  const std::string text = fuzz::text_of(data, size);
  if (text.find("plugin") != std::string::npos) return 0;  // loads a library: that is what it is for
  std::ofstream(kFolder.file(), std::ios::binary) << text;
  try {
    const Suite suite = load_suite(kFolder.file(), {});
    (void)suite.resolved.dump();
    if (suite_from_resolved(suite.resolved).points.size() != suite.points.size()) std::abort();
  } catch (const config::ConfigError&) {
  }
  return 0;
}
