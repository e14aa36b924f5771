#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace moma::reports {

/// A folder of its own for one test, removed at its end.
class Folder {
 public:
  Folder();
  ~Folder();
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Writes a made-up store of a kind (tests/tools/make_store.py).
void make_store(const std::filesystem::path& db, const std::string& kind, int worlds);

std::string read_file(const std::filesystem::path& file);

/// The data block of a page.
nlohmann::json data_of(const std::string& html);

}  // namespace moma::reports
