#include "eval/tune/tuned_file.h"

#include <fmt/format.h>

#include <cmath>

#include "controller/config/yaml_text.h"
#include "controller/describe/enumeration.h"
#include "eval/suite/sweep.h"

namespace moma::tune {
namespace {

using config::Node;

// Returns the step of one gain with the largest increase of the objective.
const SensitivityStep* steepest(const SearchResult& result, std::size_t variable) {
  const SensitivityStep* best = nullptr;
  for (const SensitivityStep& step : result.sensitivity.steps) {
    if (step.variable != variable || !step.valid) continue;
    if (best == nullptr || std::abs(step.change) > std::abs(best->change)) best = &step;
  }
  return best;
}

}  // namespace

std::string gains_table(const Tuning& tuning, const SearchResult& result) {
  std::string text = fmt::format("{:<28} {:>10} {:>10} {:>22} {:>11}  {}\n", "gain", "start", "found", "range",
                                 "importance", "objective when moved alone");
  for (std::size_t i = 0; i < tuning.config.variables.size(); ++i) {
    const Variable& v = tuning.config.variables[i];
    const SensitivityStep* step = steepest(result, i);
    const std::string moved =
        step == nullptr ? "-" : fmt::format("{:+.3g} +- {:.2g} at {}", step->change, step->error, to_text(step->value));
    text += fmt::format("{:<28} {:>10} {:>10} {:>22} {:>11}  {}\n", short_key(v.key), to_text(v.start),
                        to_text(result.found[i]),
                        fmt::format("{} [{}, {}]", to_string(v.scale), to_text(v.lower), to_text(v.upper)),
                        result.importance.empty() || std::isnan(result.importance[i])
                            ? "-"
                            : fmt::format("{:.0f} %", 100 * result.importance[i]),
                        moved);
  }
  for (const SensitivityPair& pair : result.sensitivity.pairs) {
    if (std::abs(pair.interaction) < 2 * pair.error) continue;
    text += fmt::format("{} with {}: moved together {:+.3g} +- {:.2g}\n",
                        short_key(tuning.config.variables[pair.first].key),
                        short_key(tuning.config.variables[pair.second].key), pair.interaction, pair.error);
  }
  return text;
}

std::string plan_text(const Tuning& tuning) {
  const TuneConfig& c = tuning.config;
  const std::string algorithms = joined(c.plan.empty() ? default_plan() : c.plan, &AlgorithmInfo::name, ", then ");
  return fmt::format(
      "tuning {} over {} gains by {}: {} trials at most, {} worlds{} per candidate; then {} held-out worlds",
      c.controller, c.variables.size(), algorithms, c.budget, c.worlds.count,
      c.mixture.size() > 1 ? fmt::format(" in each of {} parts", c.mixture.size()) : "", c.held_out.count);
}

std::string tuned_file(const Tuning& tuning, const SearchResult& result, const HeldOutVerdict* verdict,
                       const std::string& provenance) {
  const TuneConfig& c = tuning.config;
  std::string head = fmt::format("Gains of '{}' found by moma tune.\n{}\n\n", c.controller, provenance);
  head += fmt::format(
      "Search: {} trials, {} worlds per candidate ({} trials saved by cutting short), worlds {} to {}, confirmed "
      "on "
      "{} to {}.\n",
      result.trials, c.worlds.count, result.trials_saved, c.worlds.first, c.worlds.end() - 1, c.confirm.first,
      c.confirm.count > 0 ? c.confirm.end() - 1 : c.confirm.first);
  head += gains_table(tuning, result);
  for (const std::string& note : result.notes) head += "note: " + note + "\n";
  head += "\n";
  if (verdict == nullptr) {
    head += "Not judged on held-out worlds.";
  } else {
    head += fmt::format("Held-out worlds {} to {}{}: {} than '{}'{}.\n", c.held_out.first, c.held_out.end() - 1,
                        c.held_out_seed ? fmt::format(" of seed {}", *c.held_out_seed) : "",
                        verdict->overall == Verdict::kNoDifference ? "no difference shown, neither better nor worse"
                                                                   : std::string(to_string(verdict->overall)),
                        verdict->against, verdict->why.empty() ? "" : fmt::format(" (by {})", verdict->why));
    for (const std::string& line : verdict->constraints) head += "constraint " + line + "\n";
    head += table(*verdict);
  }
  while (head.ends_with('\n')) head.pop_back();

  Node controller = tuning.controller;
  std::string outside;
  for (std::size_t i = 0; i < c.variables.size(); ++i) {
    const std::string inner = short_key(c.variables[i].key);
    if (inner == c.variables[i].key) {
      outside +=
          fmt::format("# {}: {}   (a key of the suite, not of the controller)\n", inner, to_text(result.found[i]));
    } else {
      config::set_value(controller, inner, to_text(result.found[i]));
    }
  }
  return config::yaml_comment(head) + outside + to_yaml(controller);
}

}  // namespace moma::tune
