#include <fmt/format.h>

#include <iostream>
#include <string>

#include "controller/config/yaml_text.h"
#include "eval/cli/command.h"
#include "eval/cli/suite_options.h"
#include "eval/run/published.h"
#include "files/output_file.h"

namespace moma::cli {
namespace {

constexpr const char* kSuite =
    R"(# What is evaluated: a robot, controllers, worlds. Every key: docs/reference/suites.md, or moma keys.
name: {name}
robot: {robot}  # a Panda arm on a base with two driven wheels
controllers:                                  # NAME: FILE; every controller meets the same worlds
  published: {published}
  moma: {moma}
worlds:
  seed: 7                                     # another seed, other worlds
  families:                                   # moma world FILE INDEX shows one; moma world --help lists families
    open: {{weight: 1}}
    clutter: {{weight: 1}}
simulation: {{mode: kinematic, time_limit: 30}} # dynamic: rigid bodies, motors and wheels in ODE
success: {{position: 0.02, orientation: 0.05}}  # m and rad, to be kept for the dwell of 0.2 s
trials: 40                                    # worlds; more make the intervals narrower
samples: failures                             # time series that are kept: all, failures, none
# disturbances: {realistic}
# sweep: {{axes: {{controllers.moma.lambda_q: [0.01, 0.02, 0.04]}}}}
)";

/// Relative where the two share a folder that is not the root.
std::string path_to(const fs::path& file, const fs::path& folder) {
  const auto first_of = [](const fs::path& path) { return path.relative_path().begin()->string(); };
  const bool near = !folder.relative_path().empty() && first_of(file) == first_of(folder);
  const fs::path relative = near ? fs::relative(file, folder) : fs::path();
  return (relative.empty() ? file : relative).generic_string();
}

struct InitOptions {
  fs::path file = "first.yaml";
  files::Replace replace = files::Replace::kOwn;
};

int init(const InitOptions& options) {
  const fs::path folder = fs::absolute(options.file).parent_path();
  const fs::path configs = fs::absolute(run::find_published()).parent_path();
  const auto path = [&](const char* file) { return config::yaml_scalar(path_to(configs / file, folder)); };
  files::write_file(options.file, {"suite", ""}, options.replace, [&](std::ostream& out) {
    out << fmt::format(
        fmt::runtime(kSuite), fmt::arg("name", config::yaml_scalar(options.file.stem().string())),
        fmt::arg("robot", path("robots/frankie.yaml")), fmt::arg("published", path("controllers/holistic.yaml")),
        fmt::arg("moma", path("controllers/moma.yaml")), fmt::arg("realistic", path("disturbances/realistic.yaml")));
  });
  std::cout << fmt::format("wrote {0}. To see what it costs: moma check {0}; to run it: moma run {0}\n",
                           options.file.string());
  return kOk;
}

}  // namespace

void add_init(Commands& commands) {
  auto [command, options] = commands.add<InitOptions>("init", "Write a first suite, with a comment on each key", &init);
  command.add_option("FILE", options.file, "Suite to write (first.yaml)");
  add_force(command, options.replace);
  command.footer("Example: moma init first.yaml");
}

}  // namespace moma::cli
