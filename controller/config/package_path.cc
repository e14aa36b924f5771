#include "controller/config/package_path.h"

#include "controller/describe/enumeration.h"

#include <algorithm>
#include <cstdlib>
#include <stdexcept>
#include <string_view>
#include <vector>

namespace moma::config {
namespace {

bool is_file(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

std::vector<fs::path> and_above(const fs::path& directory) {
  std::vector<fs::path> all;
  std::error_code error;
  for (fs::path at = fs::absolute(directory.empty() ? "." : directory, error).lexically_normal(); !error;
       at = at.parent_path()) {
    if (!at.filename().empty()) all.push_back(at);
    if (at == at.parent_path()) break;
  }
  return all;
}

// share/ folders of the wheels of an environment .venv in `directory`, in the order of their names.
std::vector<fs::path> wheel_shares(const fs::path& directory) {
  std::vector<fs::path> shares;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(directory / ".venv" / "lib", error)) {
    const fs::path share = entry.path() / "site-packages" / "cmeel.prefix" / "share";
    if (entry.path().filename().string().rfind("python3", 0) == 0 && fs::is_directory(share, error))
      shares.push_back(share);
  }
  std::sort(shares.begin(), shares.end());
  return shares;
}

}  // namespace

fs::path PackagePaths::resolve(const std::string& uri) const {
  constexpr std::string_view kPackage = "package://";
  constexpr std::string_view kFile = "file://";
  if (uri.rfind(kPackage, 0) != 0) {
    fs::path path = uri.rfind(kFile, 0) == 0 ? fs::path(uri.substr(kFile.size())) : directory / uri;
    if (is_file(path)) return path;
    throw std::runtime_error("no such file: " + path.string());
  }

  const std::string rest = uri.substr(kPackage.size());
  const std::size_t slash = rest.find('/');
  if (slash == 0 || slash == std::string::npos) throw std::runtime_error("'" + uri + "' is not package://NAME/PATH");
  const std::string name = rest.substr(0, slash);
  const fs::path inside = rest.substr(slash + 1);

  std::vector<std::string> looked;
  fs::path found;
  const auto look = [&](const fs::path& package, bool report) {
    if (is_file(package / inside)) {
      found = package / inside;
      return true;
    }
    if (report) looked.push_back(package.string());
    return false;
  };

  const auto given = named.find(name);
  if (given != named.end() && look(given->second, true)) return found;
  if (const char* variable = std::getenv("MOMA_PACKAGE_PATH")) {
    std::string folders(variable);
    for (std::size_t start = 0; start <= folders.size();) {
      const std::size_t end = std::min(folders.find(':', start), folders.size());
      if (end > start && look(fs::path(folders.substr(start, end - start)) / name, true)) return found;
      start = end + 1;
    }
  }
  for (const fs::path& at : and_above(directory)) {
    if (at.filename() == name && look(at, false)) return found;
    if (look(at / name, false)) return found;
  }
  std::error_code error;
  for (const fs::path& origin : {directory, fs::path(), fs::read_symlink("/proc/self/exe", error).parent_path()}) {
    for (const fs::path& at : and_above(origin))
      for (const fs::path& share : wheel_shares(at))
        if (look(share / name, true)) return found;
  }
  throw std::runtime_error("cannot find '" + uri + "'; looked for package " + name + " in " + joined(looked) +
                           (looked.empty() ? "" : ", ") + "the folders above " +
                           (directory.empty() ? std::string("the working directory") : directory.string()) +
                           "; name its folder under `packages` or in MOMA_PACKAGE_PATH");
}

}  // namespace moma::config
