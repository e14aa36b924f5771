#include <fmt/format.h>

#include <iostream>
#include <map>

#include "controller/config/robot_file.h"
#include "eval/cli/command.h"
#include "eval/cli/suite_options.h"
#include "eval/cli/table.h"
#include "files/output_file.h"
#include "world/scenario/foreign.h"
#include "world/scenario/worlds.h"
#include "world/world_json.h"

namespace moma::cli {
namespace {

struct ImportOptions {
  std::vector<fs::path> files;
  fs::path robot;
  fs::path output;
  files::Replace replace = files::Replace::kOwn;
};

int import(const ImportOptions& options) {
  const OutputFile output(options.output, {"file of worlds", "\"difficulty\""}, options.replace);
  const ForeignWorlds found = read_foreign(config::load_robot(options.robot).model, options.files);
  std::string worlds;
  for (const World& world : found.worlds) worlds += to_json(world).dump() + '\n';
  output.write(worlds);
  if (!output.wanted()) std::cout << worlds << std::flush;
  std::map<std::string, int> families;
  for (const World& world : found.worlds) ++families[world.family];
  std::string counts;
  for (const auto& [family, count] : families)
    counts += fmt::format("{}{} {}", counts.empty() ? "" : ", ", count, terminal_safe(family));
  std::cerr << fmt::format("{} worlds: {}\n", found.worlds.size(), counts);
  for (const std::string& note : found.notes) std::cerr << "note: " << terminal_safe(note) << '\n';
  return kOk;
}

}  // namespace

void add_import(Commands& commands) {
  auto [command, options] =
      commands.add<ImportOptions>("import", "Turn planning problems of other programs into frozen worlds", &import);
  command
      .add_option("FILE", options.files,
                  "MoveIt planning scenes and requests (YAML, .scene), folders of them (MotionBenchMaker), VAMP's "
                  "problems.json, scenes of boxes")
      ->required();
  command.add_option("--robot", options.robot, "Robot file; base at the origin, poses in its URDF's root")->required();
  command.add_option("-o,--output", options.output, "Write the worlds there, one a line, for `worlds: {frozen: FILE}`");
  add_force(command, options.replace);
  command.footer("Example: moma import scene0001.yaml request0001.yaml --robot my_panda.yaml -o worlds.jsonl");
}

}  // namespace moma::cli
