#include "eval/run/risk.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "controller/config/json.h"
#include "eval/run/store_file.h"
#include "eval/run/survey.h"
#include "world/draws.h"

namespace moma::run {
namespace {

/// The score of an outcome: how near a trial came to it.
struct Nearness {
  Outcome outcome;
  const char* metric;
  double sign;
};
constexpr Nearness kNearness[] = {
    {Outcome::kCollision, "clearance_min_m", -1.0}, {Outcome::kTimeout, "time_end_s", 1.0},
    {Outcome::kStuck, "position_error_m", 1.0},     {Outcome::kJointLimit, "limit_margin_min", -1.0},
    {Outcome::kSpilled, "tilt_max_rad", 1.0},       {Outcome::kInfeasible, "fallback_brake", 1.0}};

}  // namespace

RareEvent RareEvent::read(std::string_view text) {
  const std::size_t sign = text.find_first_of("<>");
  if (sign != std::string_view::npos) {
    RareEvent event(text, tune::Metric::find(text.substr(0, sign)), text[sign] == '<' ? -1.0 : 1.0);
    const std::string_view number = text.substr(sign + 1);
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), event.value_);
    if (error != std::errc() || end != number.data() + number.size() || !std::isfinite(event.value_))
      throw std::invalid_argument(fmt::format("'{}' in {} is not a number", number, text));
    return event;
  }
  for (const Nearness& known : kNearness) {
    if (text != to_string(known.outcome)) continue;
    RareEvent event(text, tune::Metric::find(known.metric), known.sign);
    event.outcome_ = known.outcome;
    return event;
  }
  std::string list;
  for (const Nearness& known : kNearness) list += fmt::format("{}, ", to_string(known.outcome));
  throw std::invalid_argument(fmt::format("unknown event '{}'; expected {}METRIC<VALUE or METRIC>VALUE", text, list));
}

bool RareEvent::happened(const TrialRow& row) const {
  if (outcome_) return row.outcome == *outcome_;
  return row.outcome != Outcome::kError && sign_ * (level_.value(row) - value_) > 0.0;
}

double RareEvent::score(const TrialRow& row) const {
  if (happened(row)) return risk::kEvent;
  const double value = row.outcome == Outcome::kError ? kAbsent : sign_ * level_.value(row);
  return std::isnan(value) ? -std::numeric_limits<double>::infinity() : value;
}

namespace {

constexpr std::uint32_t mask(std::initializer_list<Stream> streams) {
  std::uint32_t all = 0;
  for (const Stream stream : streams) all |= 1U << static_cast<unsigned>(stream);
  return all;
}
constexpr std::uint32_t kWorldStreams = mask({Stream::kStart, Stream::kGoal, Stream::kObjects, Stream::kMotion});
constexpr std::uint32_t kNoiseStreams = mask({Stream::kSensing, Stream::kDisturbance});

/// A kind of moves. Noise has so many numbers that a share of them is drawn anew, which needs no quantile.
struct MoveKind {
  const char* name;
  std::uint32_t mask;
  bool anew;        ///< the scale is the share of numbers drawn anew
  double fraction;  ///< otherwise the share of numbers that move
};
constexpr MoveKind kMoveKinds[] = {{"world", kWorldStreams, false, 1.0},
                                   {"part of the world", kWorldStreams, false, 0.3},
                                   {"constant errors", Move::kConstantErrors, false, 1.0},
                                   {"noise", kNoiseStreams, true, 1.0}};
constexpr std::size_t kKindsOfWorld = 2;

}  // namespace

TrialParticles::TrialParticles(const SuitePoint& at, std::size_t point, std::string family, const RareEvent& event,
                               MovedTrials& trials, const Listener& listener)
    : at_(at),
      point_(point),
      family_(std::move(family)),
      event_(event),
      trials_(trials),
      listener_(listener),
      kinds_(any(at.disturbances) ? std::size(kMoveKinds) : kKindsOfWorld) {}

const char* TrialParticles::name_of_kind(std::size_t kind) { return kMoveKinds[kind].name; }

std::vector<MovedWorld> TrialParticles::unmoved(std::size_t first, std::size_t count) {
  for (std::uint64_t index = indices_.empty() ? 0 : indices_.back() + 1; indices_.size() < count; ++index)
    if (at_.worlds.family_of(index) == family_) indices_.push_back(index);
  std::vector<MovedWorld> out;
  for (std::size_t i = first; i < count; ++i) out.push_back({indices_[i], nullptr});
  return out;
}

std::vector<double> TrialParticles::scores(const std::vector<TrialRow>& rows) const {
  std::vector<double> out;
  for (const TrialRow& row : rows) out.push_back(event_.score(row));
  return out;
}

std::vector<double> TrialParticles::draw(std::size_t first, std::size_t count) {
  worlds_ = unmoved(first, first + count);
  rows_ = trials_.rows(point_, worlds_, true);
  return scores(rows_);
}

std::vector<double> TrialParticles::propose(std::span<const risk::Proposal> proposals) {
  proposed_.clear();
  places_.clear();
  for (const risk::Proposal& proposal : proposals) {
    const MoveKind& kind = kMoveKinds[proposal.kind];
    const MovedWorld& from = worlds_[proposal.place];
    auto moves = from.moves ? std::make_shared<Moves>(*from.moves) : std::make_shared<Moves>();
    if (kind.anew)
      moves->push_back({proposal.id, 1.0, proposal.scale, kind.mask});
    else
      moves->push_back({proposal.id, proposal.scale, kind.fraction, kind.mask});
    proposed_.push_back({from.index, std::move(moves)});
    places_.push_back(proposal.place);
  }
  proposed_rows_ = trials_.rows(point_, proposed_);
  return scores(proposed_rows_);
}

void TrialParticles::accept(std::size_t i) {
  worlds_[places_[i]] = proposed_[i];
  rows_[places_[i]] = proposed_rows_[i];
}

void TrialParticles::copy(std::size_t from, std::size_t to) {
  worlds_[to] = worlds_[from];
  rows_[to] = rows_[from];
}

void TrialParticles::reached(std::span<const double> levels) {
  const auto [low, high] = std::minmax_element(levels.begin(), levels.end());
  listener_.note(fmt::format("{} replicates in progress, {} {:.4g} to {:.4g}, after {} trials", levels.size(),
                             event_.level(), event_.value_of(*low), event_.value_of(*high),
                             trials_.counts().computed + trials_.counts().reused));
}

namespace {

/// Contacts without a near miss: the levels do not lead to them, and splitting is no better than crude trials.
constexpr double kNear = 0.002;  ///< [m]
constexpr int kFewContacts = 5;

struct RiskRun {
  const RiskRequest& request;
  const Suite& suite;
  const RareEvent& event;
  const Listener& listener;
  MovedTrials& trials;

  void point(std::size_t number, Risk& risk) {
    const SuitePoint& at = suite.points[number];
    const auto shares = at.worlds.shares();
    std::vector<TrialParticles> particles;
    std::vector<risk::Splitting> runs(shares.size());
    std::vector<risk::Stratum> strata;
    for (std::size_t f = 0; f < shares.size(); ++f) {
      particles.emplace_back(at, number, shares[f].first, event, trials, listener);
      strata.push_back({shares[f].second, &runs[f]});
    }
    split(at, particles, runs, strata, risk.warnings);
    RiskRow all = row_of(at, "all");
    double below = 0.0, above = 0.0;
    for (std::size_t f = 0; f < shares.size(); ++f) {
      RiskRow row = row_of(at, shares[f].first);
      for (std::size_t kind = 0; kind < runs[f].kinds.size(); ++kind)
        row.moves.emplace_back(TrialParticles::name_of_kind(kind), runs[f].kinds[kind]);
      row.trials = runs[f].evaluations;
      crude(number, particles[f], runs[f], row);
      warn_of_jumps(runs[f], row, risk.warnings);
      const risk::Stratum whole{1.0, &runs[f]};
      conclude(row, {&whole, 1}, risk.warnings);
      all.trials += row.trials;
      all.crude_trials += row.crude_trials;
      all.crude += shares[f].second * row.crude;
      below += std::pow(shares[f].second * (row.crude - row.crude_interval.low), 2);
      above += std::pow(shares[f].second * (row.crude_interval.high - row.crude), 2);
      risk.rows.push_back(std::move(row));
    }
    if (shares.size() < 2) return;
    all.crude_interval = {all.crude - std::sqrt(below), std::min(1.0, all.crude + std::sqrt(above))};
    conclude(all, strata, risk.warnings);
    risk.rows.push_back(std::move(all));
  }

  /// Runs the families' replicates: the requested ones or, with `until`, as many as the interval needs.
  void split(const SuitePoint& at, std::vector<TrialParticles>& particles, std::vector<risk::Splitting>& runs,
             const std::vector<risk::Stratum>& strata, std::vector<std::string>& warnings) const {
    const std::size_t group = request.splitting.replicates;
    for (std::size_t count = group;; count += group) {
      for (std::size_t f = 0; f < runs.size(); ++f) {
        const RiskRow row = row_of(at, at.worlds.shares()[f].first);
        listener.note(fmt::format("{}: splitting, replicates {} to {}", name(row), count - group + 1, count));
        runs[f].append(risk::split(request.splitting, particles[f], count - group));
      }
      if (!request.until) return;
      const RiskRow all = row_of(at, runs.size() == 1 ? at.worlds.shares().front().first : "all");
      const risk::Estimate now = risk::estimate(strata);
      const std::string text = fmt::format("{}: after {} replicates {:.2g} [{:.2g}, {:.2g}]", name(all), count, now.p,
                                           now.interval.low, now.interval.high);
      listener.note(text);
      if (now.p > 0.0 && now.factor() <= *request.until && now.excess() <= risk::kRefusedExcess) return;
      if (count + group <= request.most) continue;
      warnings.push_back(fmt::format("{}, NOT within a factor of {:g}", text, *request.until));
      return;
    }
  }

  static RiskRow row_of(const SuitePoint& at, const std::string& family) {
    RiskRow row;
    row.controller = at.controller;
    row.label = at.label;
    row.family = family;
    return row;
  }

  /// The first draws are crude trials already.
  void crude(std::size_t number, TrialParticles& particles, const risk::Splitting& run, RiskRow& row) {
    const std::size_t first = run.first.size();
    row.crude_trials = std::max<std::size_t>(first, request.crude.value_or(run.evaluations));
    listener.note(fmt::format("{}: {} crude trials", name(row), row.crude_trials));
    auto hits = std::ranges::count(run.first, risk::kEvent);
    for (const TrialRow& one : trials.rows(number, particles.unmoved(first, row.crude_trials), true))
      hits += event.happened(one) ? 1 : 0;
    const auto n = static_cast<std::int64_t>(row.crude_trials);
    row.crude = static_cast<double>(hits) / static_cast<double>(n);
    row.crude_interval = stats::wilson(hits, n);
  }

  void warn_of_jumps(const risk::Splitting& run, const RiskRow& row, std::vector<std::string>& warnings) const {
    if (!event.collision()) return;
    const auto contacts = std::ranges::count(run.first, risk::kEvent);
    const auto near =
        std::ranges::count_if(run.first, [](double score) { return score < risk::kEvent && score > -kNear; });
    if (contacts < kFewContacts || 10 * near >= contacts) return;
    warnings.push_back(
        fmt::format("{}: {} contacts and {} near misses (below {:g} mm) among the first draws: no level leads to "
                    "contacts without near misses, and splitting is no better than crude trials",
                    name(row), contacts, near, 1e3 * kNear));
  }

  void conclude(RiskRow& row, std::span<const risk::Stratum> strata, std::vector<std::string>& warnings) const {
    row.estimate = risk::estimate(strata);
    row.way = risk::exceedances(strata);
    row.replicates = strata.front().run->replicates.size();
    std::size_t cut = 0;
    row.ancestors = strata.front().run->particles;
    for (const risk::Stratum& stratum : strata) {
      for (const risk::Replicate& replicate : stratum.run->replicates) {
        row.ancestors = std::min(row.ancestors, replicate.ancestors);
        row.died += replicate.died_out ? 1 : 0;
        row.tied = std::max(row.tied, replicate.tied);
        cut += replicate.cut ? 1 : 0;
      }
    }
    const double excess = row.estimate.excess();
    if (row.refused())
      warnings.push_back(fmt::format(
          "{}: no estimate: replicates differ {:.1f} times as much as they should; more --particles, or crude trials",
          name(row), excess));
    else if (excess > risk::kDoubtfulExcess)
      warnings.push_back(fmt::format("{}: in doubt: replicates differ {:.1f} times as much as they should (1 to 1.5)",
                                     name(row), excess));
    if (cut > 0 && strata.size() == 1)
      warnings.push_back(fmt::format("{}: {} replicates were cut after {} levels and count as 0", name(row), cut,
                                     request.splitting.levels));
  }

  static std::string name(const RiskRow& row) {
    return fmt::format("{}{}{}, {}", row.controller, row.label.empty() ? "" : " ", row.label, row.family);
  }
};

Json to_json(const RiskRow& row, const RareEvent& event) {
  const risk::Estimate& e = row.estimate;
  Json way = Json::array(), moves = Json::object();
  for (const risk::Exceedance& at : row.way)
    way.push_back({event.value_of(at.score), at.p, at.interval.low, at.interval.high, at.crude});
  for (const auto& [kind, count] : row.moves) moves[kind] = {count.accepted, count.proposed};
  return {{"controller", row.controller},
          {"point", row.label},
          {"family", row.family},
          {"event", event.text()},
          {"level", event.level()},
          {"at", event.at() ? Json(*event.at()) : Json()},
          {"p", e.p},
          {"low", e.interval.low},
          {"high", e.interval.high},
          {"refused", row.refused()},
          {"replicates", row.replicates},
          {"trials", row.trials},
          {"crude", row.crude},
          {"crude_low", row.crude_interval.low},
          {"crude_high", row.crude_interval.high},
          {"crude_trials", row.crude_trials},
          {"excess", e.excess()},
          {"died", row.died},
          {"ancestors", row.ancestors},
          {"tied", row.tied},
          {"moves", std::move(moves)},
          {"way", std::move(way)}};
}

}  // namespace

std::string price_of_risk(const RiskRequest& request, const Suite& suite) {
  const int threads = threads_of(request);
  WorldSurvey survey;
  const TrialTime time = trial_time(suite, 1.0, survey);
  double runs = 0.0;
  for (const SuitePoint& point : suite.points) runs += static_cast<double>(point.worlds.shares().size());
  const auto price = [&](double p) {
    const double trials = risk::expected_evaluations(request.splitting, p);
    const double crude =
        request.crude
            ? std::max(0.0, static_cast<double>(*request.crude) - risk::expected_evaluations(request.splitting, 1.0))
            : trials;
    const double all = runs * (trials + crude);
    return fmt::format("p = {:g}: {:.0f} trials, {:.0f} min", p, all, all * time.each / threads / 60.0);
  };
  return fmt::format(
      "price: a trial takes {:.0f} ms; {} x {} particles, {} moves a copy, for each controller and family ({}), crude "
      "trials included, on {} threads: {}; {}; {}{}",
      1e3 * time.each, request.splitting.replicates, request.splitting.particles, request.splitting.moves, runs,
      threads, price(1e-2), price(1e-4), price(1e-6),
      request.until ? fmt::format("; at most {} times that, until the interval is within a factor of {:g}",
                                  std::max<std::size_t>(1, request.most / request.splitting.replicates), *request.until)
                    : "");
}

Risk estimate_risk(const RiskRequest& request, const Suite& suite, const RareEvent& event, const Listener& listener) {
  check_drawn(suite, "risk");
  Risk risk;
  const auto work = [&](MovedTrials& trials) {
    RiskRun run{request, suite, event, listener, trials};
    for (std::size_t p = 0; p < suite.points.size(); ++p) run.point(p, risk);
    Json rows = Json::array();
    for (const RiskRow& row : risk.rows) rows.push_back(to_json(row, event));
    trials.keep(rows);
    if (trials.counts().errors > 0)
      risk.warnings.push_back(fmt::format("{} trials ended with an error and count as no event; the first: {}",
                                          trials.counts().errors, trials.counts().first_error));
  };
  static_cast<Ended&>(risk) = with_moved_trials(request, suite, event.level(), listener, work);
  return risk;
}

}  // namespace moma::run
