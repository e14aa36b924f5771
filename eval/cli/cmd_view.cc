#include <fmt/format.h>

#include <iostream>
#include <memory>

#include "eval/cli/command.h"
#include "eval/cli/interrupt.h"
#include "eval/cli/page_parts.h"
#include "eval/cli/suite_options.h"
#include "reports/render/view.h"

namespace moma::cli {

void add_view(CLI::App& app, Action& action, const Arguments& /*arguments*/) {
  struct Options {
    reports::Stores stores;
    int port = 8080;
    std::vector<std::filesystem::path> robots;
    bool shapes = false;
    Plugins plugins = Plugins::kRefused;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("view", "Serve a store's report page on this machine, also while a run goes on");
  command->add_option("DB", options->stores, "Store; several are compared")->required();
  command->add_option("--port", options->port, "Port of 127.0.0.1 (8080); 0: any free one")
      ->check(CLI::Range(0, 65535));
  add_look_options(*command, options->robots, options->shapes);
  add_allow_plugins(*command, options->plugins);
  command->footer("Example: moma view results/demo.db --port 0");
  command->callback([&action, options] {
    action = [options] {
      run::StoredSuites suites(options->plugins);
      reports::ViewOptions view;
      view.port = options->port;
      view.simulate = simulated_again(suites);
      view.time_known = time_known;
      if (!options->shapes) view.look = robot_look(options->robots);
      const InterruptGuard guard;
      reports::serve(options->stores, view, InterruptGuard::flag(), [](const std::string& address) {
        std::cout << address << std::endl;
        std::cerr << "serving the report at the address above; Ctrl-C ends\n";
      });
      return static_cast<int>(kOk);
    };
  });
}

}  // namespace moma::cli
