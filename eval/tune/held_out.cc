#include "eval/tune/held_out.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "eval/suite/resolve.h"

namespace moma::tune {
namespace {

// How the parts of a mixture are told apart: "robot=tiago".
std::string part_name(const Overrides& part) {
  std::string name;
  for (const auto& [key, text] : part) {
    std::string value = text;
    value.erase(std::remove(value.begin(), value.end(), '"'), value.end());
    if (value.ends_with(".yaml")) value = std::filesystem::path(value).stem().string();
    name += fmt::format("{}{}={}", name.empty() ? "" : " ", short_key(key), value);
  }
  return name;
}

}  // namespace

HeldOut make_held_out(const Tuning& given, const Candidate& found) {
  const TuneConfig& config = given.config;
  Tuning tuning = given;
  if (config.held_out_seed) {
    tuning.overrides.emplace_back("worlds.seed", fmt::format("{}", *config.held_out_seed));
    tuning.suites = tuning.held_out_suites;
  }
  const Points points(tuning);
  const std::vector<SuitePoint> tuned = points.make(found);
  const std::vector<SuitePoint> start = points.make(start_of(config.variables));

  HeldOut held_out;
  held_out.found = config.controller + "-tuned";
  bool start_differs = false;
  for (std::size_t part = 0; part < tuning.suites.size(); ++part) {
    start_differs =
        start_differs || !points.same_worlds() ||
        start[part].controller_resolved != tuning.suites[part].points[tuning.tuned_point[part]].controller_resolved;
  }
  const bool many = tuning.suites.size() > 1;
  const auto add = [&](SuitePoint point, std::size_t part, const std::string& name) {
    point.controller = name;
    point.label = many ? held_out.part_names[part] : "";
    point.params = nlohmann::ordered_json::object();
    if (many) {
      for (const auto& [key, text] : config.mixture[part])
        point.params[key] = nlohmann::ordered_json::parse(text, nullptr, false);
    }
    held_out.suite.points.push_back(std::move(point));
    held_out.part.push_back(part);
    if (part == 0 && name != held_out.found) held_out.others.push_back(name);
  };
  for (std::size_t part = 0; part < tuning.suites.size(); ++part) {
    held_out.part_names.push_back(many ? part_name(config.mixture[part]) : "");
    // The tuned controller's preset comes first: the verdict is against it.
    const std::vector<SuitePoint>& all = tuning.suites[part].points;
    add(all[tuning.tuned_point[part]], part, config.controller);
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (i != tuning.tuned_point[part]) add(all[i], part, all[i].controller);
    }
    if (start_differs) add(start[part], part, config.controller + "-start");
    add(tuned[part], part, held_out.found);
  }
  held_out.suite.name = tuning.suites.front().name + "-held-out";
  held_out.suite.trials = config.held_out.count;
  held_out.suite.samples = tuning.suites.front().samples;
  held_out.suite.resolved = resolved_json(held_out.suite, true);
  held_out.jobs = make_jobs(held_out.suite.points, config.held_out.first, config.held_out.count);
  return held_out;
}

}  // namespace moma::tune
