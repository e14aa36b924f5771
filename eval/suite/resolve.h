#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "eval/suite/controller_entry.h"
#include "eval/suite/suite.h"

namespace moma {

// Inner parts of load_suite() and suite_from_resolved(); not for users.

/// A robot with the digest of its resolved form.
struct SuiteRobot {
  std::shared_ptr<const config::LoadedRobot> robot;
  std::string digest;
};

/// All sections of a suite at one assignment of the sweep, read and checked.
struct Sections {
  SuiteRobot robot;
  std::vector<std::pair<std::string, SuiteController>> controllers;  ///< in file order
  Worlds worlds;
  SimulationConfig simulation;
  SuccessRule success;
  StuckRule stuck;
  InfeasibleRule infeasible;
  Disturbances disturbances;
};

/// Reads the sections out of the suite's root map; keys that are not theirs are ignored here.
/// `robot` replaces reading the key `robot`.
Sections read_sections(const config::Node& root, const SuiteRobot& robot, std::vector<std::string>& warnings,
                       Plugins plugins = Plugins::kOfSuite);

/// The point of one controller of `sections`.
SuitePoint make_point(const Sections& sections, std::size_t controller);

/// What every point must satisfy together, and what is allowed but doubtful: fills suite.warnings; throws.
void check_suite(Suite& suite, const config::Mark& mark);

/// The whole of a suite as JSON, from its points. Sections of the first point stand at the top, as in a suite file;
/// with a sweep, `points` lists each point with the sections in which it differs.
nlohmann::ordered_json resolved_json(const Suite& suite, bool swept);

/// Keys of a suite file, and of its resolved form, where `disturbances` stands only if there are any: what a suite
/// without them resolves to does not depend on what could be disturbed.
inline constexpr const char* kSectionKeys[] = {"worlds", "simulation", "success",
                                               "stuck",  "infeasible", "disturbances"};

void add_warning(std::vector<std::string>& warnings, std::string text);

}  // namespace moma
