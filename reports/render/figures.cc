#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>

#include "reports/render/assets.h"
#include "reports/render/files.h"
#include "reports/render/page_data.h"
#include "reports/render/report.h"

namespace moma::reports {
namespace {

namespace fs = std::filesystem;

constexpr const char* kNode =
    "figures are drawn by the program node, 18 or newer (Debian package nodejs), which is not found; without it, the "
    "page's own buttons save them (moma report STORE -o PAGE.html)";

/// An empty folder among the system's temporary ones while it lives.
struct TemporaryFolder {
  std::string path = (fs::temp_directory_path() / "moma-figures-XXXXXX").string();
  TemporaryFolder() {
    if (mkdtemp(path.data()) == nullptr)
      throw ReportError(fmt::format("{}: no temporary folder can be made: {}", path, std::strerror(errno)));
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
};

std::string text_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  if (in.bad() || text.bad()) throw ReportError(fmt::format("{} cannot be read to its end", file.string()));
  return text.str();
}

/// Runs a program, its messages to ours, and waits for it. Its exit code; 127 where there is no such program.
int run(std::vector<std::string> words) {
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  pid_t child = 0;
  if (const int error = posix_spawnp(&child, argv[0], nullptr, nullptr, argv.data(), environ); error != 0) {
    if (error == ENOENT) return 127;
    throw ReportError(fmt::format("{} cannot be run: {}", words[0], std::strerror(error)));
  }
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 1;
}

}  // namespace

std::vector<fs::path> write_figures(const Stores& stores, const fs::path& folder, files::Replace replace) {
  const nlohmann::ordered_json page = read_stores(stores, {});
  const TemporaryFolder temporary;
  const fs::path work = temporary.path;
  const fs::path drawn = work / "drawn";
  const files::Kind none;
  write_text(work / "figures.mjs", none, files::Replace::kOwn, std::string(figures_js()));
  write_text(work / "page.json", none, files::Replace::kOwn,
             page.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
  fs::create_directory(drawn);
  const int code = run({"node", (work / "figures.mjs").string(), (work / "page.json").string(), drawn.string()});
  if (code == 127) throw ReportError(kNode);
  if (code != 0) throw ReportError("node could not draw the figures (its message is above)");
  std::error_code error;
  fs::create_directories(folder, error);
  if (!fs::is_directory(folder, error)) {
    throw ReportError(fmt::format("{}: cannot be made; wanted: a folder for the figures", folder.string()));
  }
  struct Figure {
    fs::path file;
    files::Kind kind;
    std::string text;
  };
  std::vector<Figure> figures;
  for (const auto& entry : fs::directory_iterator(drawn)) {
    const fs::path file = folder / entry.path().filename();
    // Both kinds may go on after their end: by comments.
    const std::string mark =
        file.extension() == ".svg" ? "<!-- A figure by moma report -->" : "% A figure by moma report";
    const files::Kind kind{"figure by moma report", mark};
    figures.push_back({file, kind, text_of(entry.path()) + mark + "\n"});
    files::check_replace(file, kind, replace);
  }
  std::vector<fs::path> written;
  for (const Figure& figure : figures) {
    write_text(figure.file, figure.kind, replace, figure.text);
    written.push_back(figure.file);
  }
  std::sort(written.begin(), written.end());
  return written;
}

bool open_in_browser(const fs::path& html) {
  const char* chosen = std::getenv("BROWSER");
  return run({chosen != nullptr && *chosen != '\0' ? chosen : "xdg-open", fs::absolute(html).string()}) == 0;
}

}  // namespace moma::reports
