#include <cstdio>
#include <cstdlib>
#include <exception>

#include "reports/render/report.h"

/// make_report STORE HTML [REPLAYS]: for the tests of the page in a browser.
int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: make_report STORE HTML [REPLAYS]\n");
    return 2;
  }
  moma::ReportOptions options;
  if (argc > 3) options.replays = std::atoi(argv[3]);
  try {
    moma::write_report(argv[1], argv[2], options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
  return 0;
}
