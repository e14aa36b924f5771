#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "reports/render/report.h"

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

/// The data of the page of these stores, which is written beside the first of them.
nlohmann::json page_of(const Stores& stores, const ReportOptions& options = {});

/// Runs SQL that changes a store.
void change(const std::filesystem::path& db, const std::string& sql);

/// The cell of a trial in a column of the page.
template <class Json>
Json page_cell(const Json& column, std::size_t row) {
  if (column.is_array()) return column.at(row);
  const int code = column.at("codes").at(row).template get<int>();
  return code < 0 ? Json(nullptr) : column.at("values").at(static_cast<std::size_t>(code));
}

}  // namespace moma::reports
