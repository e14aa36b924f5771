#include "reports/render/browser.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>
#include <thread>
#include <vector>

#include "reports/render/report.h"

namespace moma::reports {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr std::array kNames = {"chromium", "chromium-browser", "google-chrome", "google-chrome-stable"};
constexpr int kSilenceMs = 120'000;

fs::path program() {
  const char* path = std::getenv("PATH");
  for (const char* name : kNames) {
    std::istringstream folders(path != nullptr ? path : "");
    for (std::string folder; std::getline(folders, folder, ':');) {
      const fs::path file = fs::path(folder) / name;
      if (!folder.empty() && access(file.c_str(), X_OK) == 0) return file;
    }
  }
  throw ReportError(
      "videos are drawn by Chromium, which is not found; wanted on the PATH: chromium, chromium-browser, google-chrome "
      "or google-chrome-stable (Debian package chromium)");
}

/// Two ends of a line; both are closed by exec, dup2() apart.
std::array<int, 2> line() {
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0)
    throw ReportError(fmt::format("no socket can be made: {}", std::strerror(errno)));
  // Numbers that the child's own 3 and 4 cannot overwrite.
  for (int& end : ends) {
    const int high = fcntl(end, F_DUPFD_CLOEXEC, 10);
    close(end);
    end = high;
  }
  return ends;
}

}  // namespace

Browser::Browser(int width, int height) : folder_{temporary_folder("browser")} {
  const fs::path chromium = program();
  std::vector<std::string> arguments = {chromium.string(),
                                        "--headless",
                                        "--remote-debugging-pipe",
                                        "--no-first-run",
                                        "--disable-sync",
                                        "--disable-background-networking",
                                        "--disable-component-update",
                                        "--hide-scrollbars",
                                        "--mute-audio",
                                        "--use-angle=swiftshader",
                                        "--enable-unsafe-swiftshader",
                                        "--force-device-scale-factor=1",
                                        "--force-color-profile=srgb",
                                        fmt::format("--user-data-dir={}", (folder_.path / "profile").string()),
                                        fmt::format("--window-size={},{}", width, height)};
  if (geteuid() == 0) arguments.push_back("--no-sandbox");  // for root there is none
  arguments.push_back("about:blank");
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);

  const std::array<int, 2> down = line();
  const std::array<int, 2> up = line();
  to_ = down[0];
  from_ = up[0];
  posix_spawn_file_actions_t files{};
  posix_spawnattr_t group{};
  posix_spawn_file_actions_init(&files);
  posix_spawnattr_init(&group);
  const std::string words = (folder_.path / "words").string();
  posix_spawn_file_actions_addopen(&files, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&files, 1, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&files, 2, words.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  posix_spawn_file_actions_adddup2(&files, down[1], 3);
  posix_spawn_file_actions_adddup2(&files, up[1], 4);
  // A group of its own: its many processes end together, and Ctrl-C reaches moma first.
  posix_spawnattr_setflags(&group, POSIX_SPAWN_SETPGROUP);
  posix_spawnattr_setpgroup(&group, 0);
  const int error = posix_spawn(&process_, chromium.c_str(), &files, &group, argv.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  posix_spawnattr_destroy(&group);
  close(down[1]);
  close(up[1]);
  if (error != 0) {
    process_ = 0;
    end();
    throw ReportError(fmt::format("{} cannot be run: {}", chromium.string(), std::strerror(error)));
  }
  try {
    const Json target =
        call("Target.createTarget", {{"url", "about:blank"}, {"newWindow", true}, {"width", width}, {"height", height}},
             false);
    page_ =
        call("Target.attachToTarget", {{"targetId", target.at("targetId")}, {"flatten", true}}, false).at("sessionId");
    call("Page.enable", Json::object(), true);
  } catch (...) {
    end();
    throw;
  }
}

Browser::~Browser() { end(); }

void Browser::end() noexcept {
  if (to_ >= 0) close(to_);
  if (from_ >= 0) close(from_);
  to_ = from_ = -1;
  if (process_ <= 0) return;
  kill(-process_, SIGKILL);  // it holds nothing that is worth a farewell
  while (waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {
  }
  process_ = 0;
}

void Browser::fail(const std::string& what) {
  std::ifstream in(folder_.path / "words");
  std::string last;
  for (std::string text; std::getline(in, text);)
    if (!text.empty()) last = text;
  throw ReportError(fmt::format("Chromium {}{}", what, last.empty() ? "" : "; its last words: " + last));
}

Json Browser::receive() {
  std::size_t end = received_.find('\0');
  while (end == std::string::npos) {
    pollfd waited{from_, POLLIN, 0};
    const int ready = poll(&waited, 1, kSilenceMs);
    if (ready < 0 && errno == EINTR) continue;
    if (ready <= 0) fail("does not answer");
    std::array<char, 1 << 16> part{};
    const ssize_t n = read(from_, part.data(), part.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) fail("has ended by itself");
    const std::size_t before = received_.size();
    received_.append(part.data(), static_cast<std::size_t>(n));
    end = received_.find('\0', before);
  }
  Json message = Json::parse(received_.substr(0, end));
  received_.erase(0, end + 1);
  return message;
}

Json Browser::call(const std::string& method, const Json& parameters, bool in_page) {
  Json message = {{"id", ++last_call_}, {"method", method}, {"params", parameters}};
  if (in_page) message["sessionId"] = page_;
  const std::string text = message.dump();
  for (std::size_t sent = 0; sent <= text.size();) {  // its closing zero goes too
    const ssize_t n = send(to_, text.c_str() + sent, text.size() + 1 - sent, MSG_NOSIGNAL);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) fail("has ended by itself");
    sent += static_cast<std::size_t>(n);
  }
  while (true) {
    const Json answer = receive();
    if (answer.value("method", "") == "Page.loadEventFired") loaded_ = true;
    if (answer.value("id", 0L) != last_call_) continue;
    if (answer.contains("error")) fail(fmt::format("refuses {}: {}", method, answer.at("error").value("message", "")));
    return answer.at("result");
  }
}

void Browser::open(const fs::path& html) {
  loaded_ = false;
  const Json answer = call("Page.navigate", {{"url", "file://" + fs::absolute(html).string()}}, true);
  if (answer.contains("errorText"))
    fail(fmt::format("cannot open {}: {}", html.string(), answer.value("errorText", "")));
  while (!loaded_) loaded_ = receive().value("method", "") == "Page.loadEventFired";
}

Json Browser::evaluate(const std::string& expression) {
  const Json answer =
      call("Runtime.evaluate", {{"expression", expression}, {"awaitPromise", true}, {"returnByValue", true}}, true);
  if (answer.contains("exceptionDetails")) {
    const Json& details = answer.at("exceptionDetails");
    const Json raised = details.value("exception", Json::object());
    throw ReportError("the page could not draw the motion: " +
                      raised.value("description", details.value("text", "no reason given")));
  }
  return answer.at("result").value("value", Json());
}

bool open_in_browser(const std::filesystem::path& html) {
  const char* chosen = std::getenv("BROWSER");
  std::string program = chosen != nullptr && *chosen != '\0' ? chosen : "xdg-open";
  std::string file = fs::absolute(html).string();
  char* arguments[] = {program.data(), file.data(), nullptr};
  pid_t child = 0;
  if (posix_spawnp(&child, program.c_str(), nullptr, nullptr, arguments, environ) != 0) return false;
  int status = 0;
  while (waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) return false;
  }
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace moma::reports
