#pragma once

#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "controller/config/paths.h"
#include "eval/suite/controller_entry.h"
#include "eval/suite/suite.h"
#include "eval/tune/tune_config.h"

namespace moma::tune {

/// A suite with a `tune` section, everything read and checked: starts resolved, one loaded suite per part of the
/// mixture, worlds in range.
struct Tuning {
  fs::path file;
  Overrides overrides;
  TuneConfig config;
  std::vector<Suite> suites;             ///< per part of the mixture, without any sweep
  std::vector<Suite> held_out_suites;    ///< likewise, where the held-out worlds have a seed of their own
  std::vector<std::size_t> tuned_point;  ///< per part: index of the tuned controller's point
  config::Node controller;               ///< the tuned controller as written, its includes resolved
  fs::path controller_file;              ///< file of the controller; the suite for an inline one
  std::vector<std::string> warnings;
  Json identity;  ///< all that decides the search's path: equal identities, equal bits
};

/// Reads SUITE. Throws config::ConfigError.
Tuning load_tuning(const fs::path& file, const Overrides& overrides = {});

/// The stored rows of a search do not suffice to rebuild its tuning; what() says why.
class NotStored : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The tuning of a stored search, from columns `identity` and `held_out` (null: without a verdict). `robots`: resolved
/// ones by their digests. Throws NotStored, PluginRefused, and others for what no moma writes.
Tuning stored_tuning(const Json& identity, const Json& held_out, const std::map<std::string, Json>& robots,
                     Plugins plugins);

/// Search settings of a tuning. A world of the search is (index, part): number index * parts + part.
SearchSettings search_settings(const Tuning& tuning);
struct WorldOfPart {
  std::uint64_t index = 0;
  std::size_t part = 0;
};
WorldOfPart world_of(const Tuning& tuning, std::uint64_t number);

/// Points with a candidate's values in place, one per part of the mixture.
class Points {
 public:
  explicit Points(const Tuning& tuning);
  /// Throws config::ConfigError where the values contradict each other or a key does not exist. Controller keys are
  /// set on the resolved controller (microseconds); other keys read the suite again (as long as loading it takes).
  std::vector<SuitePoint> make(const Candidate& candidate) const;
  /// True where worlds, robot and simulation are the same for all candidates.
  bool same_worlds() const { return only_controller_; }

 private:
  std::vector<SuitePoint> from_controller(const Candidate& candidate) const;
  std::vector<SuitePoint> from_suite(const Candidate& candidate) const;
  const Tuning& tuning_;
  std::vector<config::Node> resolved_;   ///< per part: the tuned controller with all defaults
  std::vector<std::string> inner_keys_;  ///< keys without "controller."
  bool only_controller_ = true;
};

/// The objective in words, for tables and the store.
std::string objective_text(const Tuning& tuning);

}  // namespace moma::tune
