#include "reports/render/evidence.h"

#include <cmath>
#include <map>
#include <new>
#include <numbers>

#include "reports/render/assets.h"
#include "reports/render/store.h"

namespace moma::reports {
namespace {

using Found = std::map<std::string, double>;  // by trial

/// Empty if the goal moves or lies at the base.
std::optional<double> goal_bearing(SQLite::Statement& row) {
  const Json goal = parse_stored(row.getColumn("json_world").getString()).at("goal");
  if (goal.contains("motion") && goal.at("motion").value("kind", "") != "static") return {};
  const Samples samples(samples_of(row));
  if (samples.at("t").empty()) return {};
  const double x = goal.at("position").at(0).get<double>() - samples.at("base_x").back();
  const double y = goal.at("position").at(1).get<double>() - samples.at("base_y").back();
  if (!(std::hypot(x, y) > 1e-6)) return {};
  return std::remainder(std::atan2(y, x) - samples.at("base_phi").back(), 2.0 * std::numbers::pi);
}

HitObject question(SQLite::Statement& row) {
  const Samples samples(samples_of(row));
  HitObject ask{row.getColumn("json_world").getString(),
                row.getColumn("disturbances").getString(),
                row.getColumn("object").getString(),
                row.getColumn("control_period_s").getDouble(),
                row.getColumn("collision_time_s").getDouble(),
                {},
                {}};
  const auto t = samples.at("t");
  ask.t.assign(t.begin(), t.end());
  const auto x = samples.at("base_x"), y = samples.at("base_y"), phi = samples.at("base_phi");
  for (std::size_t i = 0; i < t.size(); ++i) ask.base.insert(ask.base.end(), {x[i], y[i], phi[i]});
  return ask;
}

void add_column(const std::string& name, const Found& found, Json& page) {
  if (found.empty()) return;
  Json& columns = page["trials"]["columns"];
  const Json& trials = columns.at("trial");
  Json cells = Json::array();
  for (const Json& code : trials.at("codes")) {
    const auto value = found.find(trials.at("values").at(code.get<std::size_t>()).get<std::string>());
    cells.push_back(value == found.end() ? Json(nullptr) : Json(value->second));
  }
  columns[name] = std::move(cells);
}

}  // namespace

void add_evidence(SQLite::Database& store, std::int64_t worlds, const TimeKnown& time_known, Json& page) {
  if (page.at("trials").at("n").get<long long>() == 0) return;
  SQLite::Statement query(store, std::string(evidence_sql()));
  query.bind(1, worlds);
  query.bind(2, kMostEvidence);
  Found bearings, known;
  while (query.executeStep()) {
    const std::string trial = query.getColumn("trial").getString();
    try {
      if (query.getColumn("kind").getString() == "bearing") {
        if (const std::optional<double> bearing = goal_bearing(query)) bearings[trial] = *bearing;
      } else if (time_known) {
        if (const std::optional<double> seconds = time_known(question(query))) known[trial] = *seconds;
      }
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::exception&) {
      // Inconsistent samples or worlds explain nothing here; the replay reports what is wrong with them.
    }
  }
  add_column("goal_bearing_rad", bearings, page);
  add_column("known_before_contact_s", known, page);
}

}  // namespace moma::reports
