#include <fmt/format.h>

#include <iostream>
#include <memory>

#include "eval/cli/command.h"
#include "eval/cli/interrupt.h"
#include "eval/cli/page_parts.h"
#include "reports/render/view.h"

namespace moma::cli {

void add_view(CLI::App& app, Action& action, const Arguments& /*arguments*/) {
  struct Options {
    reports::Stores stores;
    reports::ViewOptions view;
    PageOptions page;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("view", "Serve a store's report page on this machine, also while a run goes on");
  command->add_option("DB", options->stores, "Store; several are compared")->required();
  command->add_option("--port", options->view.port, "Port of 127.0.0.1 (8080); 0: any free one")
      ->check(CLI::Range(0, 65535));
  options->page.add_to(*command);
  command->footer("Example: moma view results/demo.db --port 0");
  command->callback([&action, options] {
    action = [options] {
      options->page.complete(options->view);
      const InterruptGuard guard;
      reports::serve(options->stores, options->view, InterruptGuard::flag(), [](const std::string& address) {
        std::cout << address << std::endl;
        std::cerr << "serving the report at the address above; Ctrl-C ends\n";
      });
      return static_cast<int>(kOk);
    };
  });
}

}  // namespace moma::cli
