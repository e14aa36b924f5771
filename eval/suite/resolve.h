#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "eval/suite/controller_entry.h"
#include "eval/suite/suite.h"

namespace moma {

// Internal parts of load_suite() and suite_from_resolved().

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

/// Reads the sections from the suite's root map; ignores keys of other readers. `robot` replaces the key `robot`.
Sections read_sections(const config::Node& root, const SuiteRobot& robot, std::vector<std::string>& warnings,
                       Plugins plugins = Plugins::kOfSuite);

/// Returns the point of one controller of `sections`.
SuitePoint make_point(const Sections& sections, std::size_t controller);

/// Checks conditions across all points, and adds doubts to suite.warnings; throws.
void check_suite(Suite& suite, const config::Mark& mark);

/// Returns the whole suite as JSON, from its points. Sections of the first point are at the top, as in a suite file;
/// with a sweep, `points` lists each point with its differing sections.
nlohmann::ordered_json resolved_json(const Suite& suite, bool swept);

/// Keys of a suite file and of its resolved form. `disturbances` appears only if there are any: the resolved form of a
/// suite without them is independent of later disturbances.
inline constexpr const char* kSectionKeys[] = {"worlds", "simulation", "success",
                                               "stuck",  "infeasible", "disturbances"};

void add_warning(std::vector<std::string>& warnings, std::string text);

}  // namespace moma
