#include "world/scenario/worlds.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <utility>
#include <variant>
#include <vector>

#include "controller/config/reader.h"
#include "world/scenario/apportion.h"
#include "world/scenario/family.h"
#include "world/world_json.h"

namespace moma {
namespace {

using Json = nlohmann::ordered_json;

struct Member {
  std::string name;
  double weight = 1.0;
  std::unique_ptr<const Family> family;
};

struct Mixture {
  std::uint64_t seed = 1;
  int tries = 10000;
  std::vector<Member> members;
  std::unique_ptr<const Apportionment> shares;

  const Member& at(std::uint64_t index) const { return members[static_cast<std::size_t>(shares->family_of(index))]; }
};

using Frozen = std::vector<World>;

Member read_member(const std::string& name, const config::Node& node, const std::string& key) {
  std::vector<std::string> names;
  for (const FamilyType& type : family_types()) {
    names.emplace_back(type.name);
    if (name != type.name) continue;
    config::MapReader in(node, key);
    Member member;
    member.name = name;
    in.read("weight", member.weight, config::Range::non_negative());
    member.family = type.read(in);
    in.finish();
    return member;
  }
  std::string list;
  for (const std::string& known : names) list += (list.empty() ? "" : ", ") + known;
  const std::string near = config::nearest(name, names);
  config::fail(node.key_place(), key,
               "unknown family" + (near.empty() ? "" : " (did you mean " + near + "?)") + "; families are: " + list);
}

Mixture read_mixture(config::MapReader& in) {
  Mixture mixture;
  unsigned long long seed = mixture.seed;
  in.read("seed", seed);
  mixture.seed = seed;
  in.read("tries", mixture.tries, 1, 1000000);
  const config::Node& families =
      in.require("families", "a map from family to its parameters, as in {open: {weight: 1}}");
  const std::string key = in.key_of("families");
  if (families.kind != config::Node::Kind::kMap || families.entries.empty())
    config::fail(families.mark, key, "expected a map with at least one family");
  std::vector<double> weights;
  for (const auto& [name, node] : families.entries) {
    mixture.members.push_back(read_member(name, node, key + "." + name));
    weights.push_back(mixture.members.back().weight);
  }
  double sum = 0.0;
  for (const double weight : weights) sum += weight;
  if (!(sum > 0.0) || !(sum < 1e300)) config::fail(families.mark, key, "at least one family needs a weight above 0");
  if (weights.size() > 255) config::fail(families.mark, key, "more than 255 families");
  mixture.shares = std::make_unique<const Apportionment>(std::move(weights));
  return mixture;
}

Frozen read_frozen(const config::Node& node, const std::string& key) {
  Frozen worlds;
  if (node.kind == config::Node::Kind::kSequence) {  // a resolved suite holds the worlds themselves
    for (std::size_t i = 0; i < node.items.size(); ++i)
      worlds.push_back(world_from_node(node.items[i], fmt::format("{}[{}]", key, i)));
  } else {
    std::filesystem::path path = config::read_string(node, key);
    if (path.is_relative()) path = std::filesystem::path(node.mark.file).parent_path() / path;
    std::ifstream file(path);
    if (!file) config::fail(node.mark, key, "cannot read '" + path.string() + "'; expected a file of one world a line");
    std::string line;
    for (int number = 1; std::getline(file, line); ++number) {
      if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
      const std::string where = fmt::format("{}:{}", path.string(), number);
      Json json;
      try {
        json = Json::parse(line);
      } catch (const nlohmann::json::exception& error) {
        throw config::ConfigError(fmt::format("{}: not a world in JSON: {}", where, error.what()));
      }
      worlds.push_back(world_from_json(json, where));
    }
  }
  if (worlds.empty()) config::fail(node.mark, key, "expected at least one world");
  return worlds;
}

void add(MakingLog& log, const SceneBuilder& builder, bool found, std::uint64_t tries) {
  log.worlds += found ? 1 : 0;
  log.tries += tries;
  for (const auto& [why, count] : builder.rejections()) log.rejections[why] += count;
  for (const auto& [why, count] : builder.redraws()) log.redraws[why] += count;
}

}  // namespace

struct Worlds::Data {
  double clearance = 0.05;
  std::variant<Mixture, Frozen> source;
};

Worlds Worlds::read(const config::Node& node, const std::string& key) {
  config::MapReader in(node, key);
  auto data = std::make_shared<Data>();
  in.read("clearance", data->clearance, config::Range::non_negative());
  if (const config::Node* frozen = in.get("frozen"))
    data->source = read_frozen(*frozen, in.key_of("frozen"));
  else
    data->source = read_mixture(in);
  in.finish();
  Worlds out;
  out.data_ = std::move(data);
  return out;
}

Json Worlds::to_json() const {
  Json out;
  if (const auto* frozen = std::get_if<Frozen>(&data_->source)) {
    out["clearance"] = data_->clearance;
    out["frozen"] = Json::array();
    for (const World& world : *frozen) out["frozen"].push_back(moma::to_json(world));
    return out;
  }
  const auto& mixture = std::get<Mixture>(data_->source);
  out["seed"] = mixture.seed;
  out["clearance"] = data_->clearance;
  out["tries"] = mixture.tries;
  out["families"] = Json::object();
  for (const Member& member : mixture.members) {
    Json family = {{"weight", member.weight}};
    family.update(member.family->to_json());
    out["families"][member.name] = std::move(family);
  }
  return out;
}

World Worlds::make(const std::shared_ptr<const RobotModel>& model, std::uint64_t index, MakingLog* log) const {
  if (const auto* frozen = std::get_if<Frozen>(&data_->source)) {
    if (index >= frozen->size())
      throw GenerationError(
          fmt::format("worlds.frozen: there is no world {}; the set holds {}", index, frozen->size()));
    World world = (*frozen)[index];
    if (world.start.q.size() != model->num_joints())
      throw GenerationError(fmt::format("worlds.frozen: world {} has {} joint values, robot {} has {} joints", index,
                                        world.start.q.size(), model->name, model->num_joints()));
    if (log != nullptr) ++log->worlds;
    return world;
  }
  const auto& mixture = std::get<Mixture>(data_->source);
  const Member& member = mixture.at(index);
  SceneBuilder builder(model, mixture.seed, index, data_->clearance);
  World world;
  bool found = false;
  int tries = 0;
  while (!found && tries < mixture.tries) {
    builder.begin(static_cast<std::uint64_t>(tries++), world);
    world.family = member.name;
    found = member.family->build(builder, world);
  }
  if (log != nullptr) add(*log, builder, found, static_cast<std::uint64_t>(tries));
  if (found) {
    builder.measure(world);
    return world;
  }
  throw GenerationError(fmt::format(
      "worlds.families.{}: no world {} (seed {}) for robot {} in {} tries; the constraint that failed most often: {}",
      member.name, index, mixture.seed, model->name, mixture.tries, builder.worst_constraint()));
}

std::string Worlds::family_of(std::uint64_t index) const {
  if (const auto* frozen = std::get_if<Frozen>(&data_->source))
    return index < frozen->size() ? (*frozen)[index].family : std::string();
  return std::get<Mixture>(data_->source).at(index).name;
}

Json Worlds::identity(std::uint64_t index) const {
  if (const auto* frozen = std::get_if<Frozen>(&data_->source)) {
    Json out;
    out["frozen"] = index < frozen->size() ? moma::to_json((*frozen)[index]) : Json();
    return out;
  }
  const auto& mixture = std::get<Mixture>(data_->source);
  const Member& member = mixture.at(index);
  return {{"seed", mixture.seed},
          {"index", index},
          {"clearance", data_->clearance},
          {"family", member.name},
          {"parameters", member.family->to_json()}};
}

double Worlds::clearance() const { return data_->clearance; }

std::uint64_t Worlds::seed() const {
  if (const auto* frozen = std::get_if<Frozen>(&data_->source)) return frozen->front().seed;
  return std::get<Mixture>(data_->source).seed;
}

long long Worlds::size() const {
  if (const auto* frozen = std::get_if<Frozen>(&data_->source)) return static_cast<long long>(frozen->size());
  return -1;
}

}  // namespace moma
