#pragma once

#include <sys/types.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "reports/render/files.h"

namespace moma::reports {

/// A Chromium without a window, spoken to by the Chrome DevTools Protocol through pipes; it ends with this object.
/// Programs by the names chromium, chromium-browser, google-chrome and google-chrome-stable are looked for on the PATH.
/// All members throw ReportError: no such program, one that ended (with its own last words), one that is silent for
/// two minutes, or an error that the page raised.
class Browser {
 public:
  /// With a window of so many pixels, drawing in software: the same pixels on any machine with the same Chromium.
  Browser(int width, int height);
  ~Browser();
  Browser(const Browser&) = delete;
  Browser& operator=(const Browser&) = delete;

  /// Opens a file and waits until it is loaded.
  void open(const std::filesystem::path& html);
  /// Value of an expression in the page; of a promise what it comes to.
  nlohmann::json evaluate(const std::string& expression);

 private:
  nlohmann::json call(const std::string& method, const nlohmann::json& parameters, bool in_page);
  nlohmann::json receive();
  void end() noexcept;
  [[noreturn]] void fail(const std::string& what);

  Temporary folder_;
  pid_t process_ = 0;
  int to_ = -1;
  int from_ = -1;
  long last_call_ = 0;
  std::string page_;      ///< session
  std::string received_;  ///< what has not been read yet
  bool loaded_ = false;
};

/// Shows a page in the reader's own browser, as $BROWSER or else xdg-open names it, and waits until that has started
/// it. False where there is none, or it fails.
bool open_in_browser(const std::filesystem::path& html);

}  // namespace moma::reports
