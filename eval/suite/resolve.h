#pragma once

#include <memory>
#include <string>
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

/// Reads and checks the sections from the suite's root map, at one assignment of the sweep; ignores keys of other
/// readers. `robot` replaces the key `robot`. Returns one point for each controller, in file order.
std::vector<SuitePoint> read_points(const config::Node& root, const SuiteRobot& robot,
                                    std::vector<std::string>& warnings, Plugins plugins = Plugins::kOfSuite);

/// Checks conditions across all points, and adds doubts to suite.warnings; throws.
void check_suite(Suite& suite, const config::Mark& mark);

/// Returns the whole suite as JSON, from its points. Sections of the first point are at the top, as in a suite file;
/// with a sweep, `points` lists each point with its differing sections.
Json resolved_json(const Suite& suite, bool swept);

/// Keys of a suite file and of its resolved form. `disturbances` appears only if there are any: the resolved form of a
/// suite without them is independent of later disturbances.
inline constexpr const char* kSectionKeys[] = {"worlds", "simulation", "success",
                                               "stuck",  "infeasible", "disturbances"};

void add_warning(std::vector<std::string>& warnings, std::string text);

}  // namespace moma
