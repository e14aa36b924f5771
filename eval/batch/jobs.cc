#include <map>

#include "eval/batch/batch.h"
#include "eval/trial/key.h"

namespace moma {

std::vector<BatchJob> make_jobs(std::span<const SuitePoint> points, std::uint64_t first, std::uint64_t count) {
  std::vector<TrialKeys> keys;
  // Points that share a worlds section share the worlds' identities, which are computed once per world.
  std::vector<std::size_t> group;
  std::map<std::string, std::size_t> groups;
  for (const SuitePoint& point : points) {
    keys.emplace_back(point);
    group.push_back(groups.emplace(point.worlds.to_json().dump(), groups.size()).first->second);
  }
  std::vector<BatchJob> jobs;
  jobs.reserve(points.size() * count);
  std::vector<nlohmann::ordered_json> identities(groups.size());
  for (std::uint64_t world = first; world < first + count; ++world) {
    for (auto& identity : identities) identity = nullptr;
    for (std::size_t p = 0; p < points.size(); ++p) {
      nlohmann::ordered_json& identity = identities[group[p]];
      if (identity.is_null()) identity = points[p].worlds.identity(world);
      jobs.push_back({p, world, keys[p].key(identity)});
    }
  }
  return jobs;
}

std::vector<BatchJob> make_jobs(const Suite& suite) { return make_jobs(suite.points, 0, suite.trials); }

}  // namespace moma
