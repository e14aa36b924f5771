#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>

#include "reports/render/report.h"
#include "reports/render/view.h"

namespace {
std::atomic<bool> stop{false};
}

/// For the tests of the page in a browser:
///   make_report STORE... HTML
///   make_report --view STORE...        until SIGTERM; prints the address
int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: make_report [--view] STORE... [HTML]\n");
    return 2;
  }
  const bool view = std::strcmp(argv[1], "--view") == 0;
  const moma::reports::Stores stores(argv + (view ? 2 : 1), argv + (view ? argc : argc - 1));
  try {
    if (view) {
      std::signal(SIGTERM, [](int) { stop = true; });
      moma::reports::ViewOptions options;
      options.port = 0;
      moma::reports::serve(stores, options, stop, [](const std::string& address) {
        std::printf("%s\n", address.c_str());
        std::fflush(stdout);
      });
    } else {
      moma::reports::write_report(stores, argv[argc - 1]);
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
  return 0;
}
