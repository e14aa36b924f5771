#include "reports/render/report.h"

#include <fmt/format.h>
#include <spawn.h>
#include <sqlite3.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <ostream>
#include <set>

#include "reports/render/html.h"
#include "reports/render/page_data.h"
#include "reports/render/store.h"

namespace moma::reports {
namespace {

/// Stems of the files, with their folders where those are needed to tell them apart.
std::vector<std::string> labels_of(const Stores& stores) {
  std::vector<std::string> labels;
  for (const std::filesystem::path& store : stores) labels.push_back(store.stem().string());
  const bool distinct = std::set<std::string>(labels.begin(), labels.end()).size() == labels.size();
  for (std::size_t i = 0; i < stores.size() && !distinct; ++i) labels[i] = stores[i].string();
  return labels;
}

}  // namespace

Json read_stores(const Stores& stores, const ReportOptions& options) {
  if (stores.empty()) throw ReportError("a report needs a store; wanted: one or more, written by moma run");
  std::set<std::filesystem::path> seen;
  std::vector<Json> pages;
  ReportOptions each = options;
  each.trials = std::max<std::int64_t>(options.trials / static_cast<std::int64_t>(stores.size()), 1);
  each.replays = (options.replays + static_cast<int>(stores.size()) - 1) / static_cast<int>(stores.size());
  for (const std::filesystem::path& db : stores) {
    std::error_code ignored;
    if (!seen.insert(std::filesystem::weakly_canonical(db, ignored)).second) {
      throw ReportError(fmt::format("{}: the same store twice; wanted: different ones", db.string()));
    }
    try {
      SQLite::Database store = open_store(db, options.patience);
      pages.push_back(page_data(store, each));
    } catch (const SQLite::Exception& error) {
      if (error.getErrorCode() == SQLITE_INTERRUPT) {
        throw ReportError(fmt::format("{}: its tables and views have not been read after {} s; moma's own take seconds",
                                      db.string(), options.patience.count() / 1000.0));
      }
      throw ReportError(fmt::format("{}: cannot be read: {}", db.string(), error.what()));
    } catch (const nlohmann::json::exception& error) {
      throw ReportError(fmt::format("{}: holds JSON that cannot be read: {}", db.string(), error.what()));
    }
  }
  Json all = pages.size() == 1 ? std::move(pages.front()) : combined(std::move(pages), labels_of(stores));
  if (!options.notes.empty()) all["notes"] = options.notes;
  return all;
}

const files::Kind& page_kind() {
  static const files::Kind kind{"report page of moma's", " moma report</title>"};
  return kind;
}

void write_report(const Stores& stores, const std::filesystem::path& html_file, const ReportOptions& options) {
  if (options.trials < 1) throw ReportError("trials: wanted: 1 or more");
  if (options.replays < 0) throw ReportError("replays: wanted: 0 or more");
  if (!(options.replay_hz > 0.0)) throw ReportError("replay_hz: wanted: more than 0");
  const std::string page = html(read_stores(stores, options));
  std::error_code error;  // writing says what is wrong with a folder that cannot be made
  std::filesystem::create_directories(files::behind_links(html_file).parent_path(), error);
  try {
    files::write_file(html_file, page_kind(), options.replace,
                      [&](std::ostream& out) { out.write(page.data(), static_cast<std::streamsize>(page.size())); });
  } catch (const files::OutputError& failure) {
    throw ReportError(failure.what());
  }
}

bool open_in_browser(const std::filesystem::path& html) {
  const char* chosen = std::getenv("BROWSER");
  std::string program = chosen != nullptr && *chosen != '\0' ? chosen : "xdg-open";
  std::string page = std::filesystem::absolute(html).string();
  char* const words[] = {program.data(), page.data(), nullptr};
  pid_t child = 0;
  if (posix_spawnp(&child, words[0], nullptr, nullptr, words, environ) != 0) return false;
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace moma::reports
