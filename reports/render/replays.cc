#include "reports/render/page_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <new>

#include "reports/render/store.h"

namespace moma::reports {
namespace {

Json robot_of(SQLite::Database& store, std::int64_t id) {
  SQLite::Statement one(store, "SELECT resolved FROM robot WHERE id = ?1");
  one.bind(1, id);
  one.executeStep();
  return parse_stored(one.getColumn(0).getString());
}

Json head(SQLite::Statement& row) {
  return {{"trial", row.getColumn("trial").getString()},
          {"robot", std::to_string(row.getColumn("robot").getInt64())},
          {"world", parse_stored(row.getColumn("json_world").getString())}};
}

/// Simulates a trial again; empty if this program cannot: the page then has neither the rows of the QP nor the map.
std::optional<OwnedSamples> again(const SQLite::Database& store, const Simulate& simulate, const std::string& trial) {
  try {
    return simulate ? simulate(store.getFilename(), trial) : std::nullopt;
  } catch (const CannotSimulate&) {
    return {};
  }
}

/// Adds a trial's motion at `hz` samples per second: the stored samples, or else those of a new simulation, which also
/// gives the rows of the QP and the map. Returns false if there is neither.
bool add_motion(SQLite::Statement& row, const std::optional<OwnedSamples>& made, double hz, Json& replay) {
  const bool stored = !row.getColumn("n").isNull() && row.getColumn("n").getInt64() > 0;
  if (!stored && (!made || made->n == 0)) return false;
  replay.update(replay_data(stored ? samples_of(row) : made->view(), hz, made ? &made->rows : nullptr,
                            made ? &made->map : nullptr));
  return true;
}

/// Adds a success in the same world as a failed trial, if its motion is available.
void add_twin(SQLite::Database& store, const ReportOptions& options, const std::string& failed, Json& page) {
  SQLite::Statement query(store, std::string(twin_sql()));
  query.bind(1, failed);
  if (!query.executeStep()) return;
  const std::string trial = query.getColumn("trial").getString();
  for (const Json& replay : page["replays"]) {
    if (replay.at("trial") == trial) return;
  }
  Json replay = head(query);
  if (add_motion(query, again(store, options.simulate, trial), options.replay_hz, replay))
    page["replays"].push_back(std::move(replay));
}

}  // namespace

void add_replays(SQLite::Database& store, const ReportOptions& options, std::int64_t worlds, Json& page) {
  page["robots"] = Json::object();
  page["replays"] = Json::array();
  const auto named = [&](const std::string& trial, const auto& part) {
    try {
      part();
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::exception& error) {
      throw ReportError(fmt::format("{}: trial {}: {}", store.getFilename(), trial, error.what()));
    }
  };
  SQLite::Statement query(store, std::string(replays_sql()));
  query.bind(1, options.replays);
  query.bind(2, worlds);
  while (query.executeStep()) {
    const std::string trial = query.getColumn("trial").getString();
    if (query.getColumn("n").getInt64() == 0) continue;
    if (options.served) {
      page["replays"].push_back({{"trial", trial}});
      continue;
    }
    named(trial, [&] {
      Json replay = head(query);
      add_motion(query, again(store, options.simulate, trial), options.replay_hz, replay);
      const std::string robot = replay["robot"];
      if (!page["robots"].contains(robot)) page["robots"][robot] = robot_of(store, query.getColumn("robot").getInt64());
      page["replays"].push_back(std::move(replay));
    });
  }
  if (options.served) return;
  const std::size_t failures = std::min<std::size_t>(page["replays"].size(), std::max(options.twins, 0));
  for (std::size_t i = 0; i < failures; ++i) {
    const std::string trial = page["replays"][i].at("trial");
    named(trial, [&] { add_twin(store, options, trial, page); });
  }
}

std::optional<Json> replay_of(SQLite::Database& store, const std::string& trial, double hz, const Simulate& simulate) {
  SQLite::Statement query(store, std::string(replay_sql()));
  query.bind(1, trial);
  if (!query.executeStep()) return {};
  Json replay = head(query);
  const bool stored = !query.getColumn("n").isNull();
  const std::optional<OwnedSamples> made = stored     ? again(store, simulate, trial)
                                           : simulate ? simulate(store.getFilename(), trial)
                                                      : std::nullopt;
  if (!add_motion(query, made, hz, replay)) replay["n"] = 0;
  replay["simulated"] = !stored;
  replay["resolved"] = robot_of(store, query.getColumn("robot").getInt64());
  return replay;
}

}  // namespace moma::reports
