#include "tests/reports/store_files.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace moma::reports {

Folder::Folder() {
  std::string name = (std::filesystem::temp_directory_path() / "moma-report-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("cannot make a folder like " + name);
  path_ = name;
}

Folder::~Folder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

void make_store(const std::filesystem::path& db, const std::string& kind, int worlds) {
  static std::map<std::pair<std::string, int>, std::string> made;  // Python takes longer than a copy
  const auto found = made.find({kind, worlds});
  if (found != made.end()) {
    std::ofstream(db, std::ios::binary) << found->second;
    return;
  }
  const std::string root = MOMA_SOURCE_DIR;
  const std::string command = "python3 '" + root + "/tests/tools/make_store.py' '" + MOMA_BINARY_DIR +
                              "/eval/store/definition' '" + db.string() + "' --kind " + kind + " --worlds " +
                              std::to_string(worlds) + " --samples 8";
  if (std::system(command.c_str()) != 0) throw std::runtime_error("failed: " + command);
  made[{kind, worlds}] = read_file(db);
}

std::string read_file(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error("cannot read " + file.string());
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

nlohmann::json data_of(const std::string& html) {
  const std::string open = "<script type=\"application/json\" id=\"moma-data\">";
  const std::size_t from = html.find(open);
  if (from == std::string::npos) throw std::runtime_error("the page has no data block");
  const std::size_t start = from + open.size();
  // What a browser does: the block ends at the first end tag.
  return nlohmann::json::parse(html.substr(start, html.find("</script", start) - start));
}

nlohmann::json page_of(const Stores& stores, const ReportOptions& options) {
  const std::filesystem::path html = stores.front().parent_path() / "page.html";
  write_report(stores, html, options);
  return data_of(read_file(html));
}

void change(const std::filesystem::path& db, const std::string& sql) {
  SQLite::Database(db.string(), SQLite::OPEN_READWRITE).exec(sql);
}

}  // namespace moma::reports
