#include "world/scenario/worlds.h"

#include <fmt/format.h>
#include <fstream>
#include <variant>

#include "controller/config/json_node.h"
#include "controller/config/reader.h"
#include "controller/config/text_file.h"
#include "world/holding.h"
#include "world/scenario/apportionment.h"
#include "world/scenario/family.h"
#include "world/scenario/scenes.h"
#include "world/world_json.h"

namespace moma {

namespace {

/// Keys beside `families`.
struct Making {
  std::uint64_t seed = 1;
  double clearance = 0.05;  ///< [m]
  double start_room = 0.0;  ///< [m]
  int tries = 10000;
};

constexpr void describe(auto& v, Of<Making>) {
  using T = Making;
  v.member("seed", &T::seed, {.text = "seed of the worlds"});
  v.member("clearance", &T::clearance, non_negative("m", "distance of objects from start and witness"));
  v.member("start_room", &T::start_room,
           unless_default(in_range({0.0, 10.0}, "m", "distance of objects from the robot at the start, at t = 0")));
  v.member("tries", &T::tries, in_range({1, 1000000}, "", "largest number of tries at one world, before an error"));
}

struct Member {
  std::string name;
  double weight = 1.0;
  std::unique_ptr<const Family> family;
};

/// The key that every family has besides its own.
constexpr void describe(auto& v, Of<Member>) {
  v.member("weight", &Member::weight, non_negative("", "share of the worlds"));
}

struct Mixture {
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
    config::read_members(in, member);
    member.family = type.read(in);
    in.finish();
    return member;
  }
  config::fail(node.key_place(), key,
               "unknown family" + config::suggestion(name, names) + "; families are: " + joined(names));
}

Mixture read_mixture(config::MapReader& in) {
  Mixture mixture;
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

/// Limit of a file of worlds. They become part of the resolved suite, which is read as one text.
constexpr std::uintmax_t kMaxFrozenBytes = config::kMaxTextBytes;

Frozen read_frozen(const config::Node& node, const std::string& key) {
  Frozen worlds;
  if (node.kind == config::Node::Kind::kSequence) {  // a resolved suite contains the worlds themselves
    for (std::size_t i = 0; i < node.items.size(); ++i)
      worlds.push_back(world_from_node(node.items[i], fmt::format("{}[{}]", key, i)));
  } else {
    fs::path path = config::read_string(node, key);
    if (path.is_relative()) path = config::directory_of(node.mark) / path;
    std::error_code error;
    const bool plain = fs::is_regular_file(path, error);
    if (plain && fs::file_size(path, error) > kMaxFrozenBytes) {
      config::fail(node.mark, key, fmt::format("'{}' has more than {} MiB", path.string(), kMaxFrozenBytes >> 20U));
    }
    std::ifstream file;
    if (plain) file.open(path);
    if (!plain || !file)
      config::fail(node.mark, key, "cannot read '" + path.string() + "'; expected a file of one world a line");
    std::string line;
    for (int number = 1; std::getline(file, line); ++number) {
      if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
      const std::string where = fmt::format("{}:{}", path.string(), number);
      worlds.push_back(world_from_json(config::parse_json(line, where), where));
    }
    // A stream also ends after a failure of disk or memory.
    if (file.bad()) config::fail(node.mark, key, "'" + path.string() + "' cannot be read to its end");
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

std::vector<Key> worlds_keys(const std::string& prefix) {
  std::vector<Key> keys = keys_of(Making{}, prefix);
  const auto add = [&keys](const std::vector<Key>& more) { keys.insert(keys.end(), more.begin(), more.end()); };
  keys.push_back(
      {prefix + ".frozen", "", "a file of one world a line, instead of families", "", "the worlds themselves"});
  keys.push_back({prefix + ".scenes", "", "a file of scenes with configurations of the arm, instead of families", "",
                  "a benchmark's problems: from each configuration to the tool's pose at each later one"});
  for (const FamilyType& type : family_types()) {
    const std::string family = prefix + ".families." + std::string(type.name);
    keys.push_back({family, "", "a map", "", std::string(type.text)});
    add(keys_of(Member{}, family));
    add(type.keys(family));
  }
  return keys;
}

struct Worlds::Data {
  Making making;  ///< of frozen worlds the clearance alone, of scenes nothing
  std::variant<Mixture, Frozen, Scenes> source;
};

Worlds Worlds::read(const config::Node& node, const std::string& key) {
  config::MapReader in(node, key);
  auto data = std::make_shared<Data>();
  if (const config::Node* frozen = in.get("frozen")) {
    in.read("clearance", data->making.clearance, Range::non_negative());
    data->source = read_frozen(*frozen, in.key_of("frozen"));
  } else if (const config::Node* scenes = in.get("scenes")) {
    data->making = {.seed = 0, .clearance = 0.0};
    data->source = Scenes::read(*scenes, in.key_of("scenes"));
  } else {
    config::read_members(in, data->making);
    data->source = read_mixture(in);
  }
  in.finish();
  Worlds out;
  out.data_ = std::move(data);
  return out;
}

Json Worlds::to_json() const {
  Json out = Json::object();
  if (const auto* frozen = std::get_if<Frozen>(&data_->source)) {
    out["clearance"] = data_->making.clearance;
    out["frozen"] = Json::array();
    for (const World& world : *frozen) out["frozen"].push_back(moma::to_json(world));
    return out;
  }
  if (const auto* scenes = std::get_if<Scenes>(&data_->source)) return {{"scenes", scenes->to_json()}};
  const auto& mixture = std::get<Mixture>(data_->source);
  out = config::write_described(data_->making);
  out["families"] = Json::object();
  for (const Member& member : mixture.members) {
    Json family = config::write_described(member);
    family.update(member.family->to_json());
    out["families"][member.name] = std::move(family);
  }
  return out;
}

World Worlds::make(const std::shared_ptr<const RobotModel>& model, std::uint64_t index, MakingLog* log,
                   const std::shared_ptr<const Moves>& moves) const {
  if (const auto* frozen = std::get_if<Frozen>(&data_->source)) {
    if (index >= frozen->size())
      throw GenerationError(
          fmt::format("worlds.frozen: there is no world {}; the set holds {}", index, frozen->size()));
    World world = (*frozen)[index];
    if (world.start.q.size() != model->num_joints())
      throw GenerationError(fmt::format("worlds.frozen: world {} has {} joint values, robot {} has {} joints", index,
                                        world.start.q.size(), model->name, model->num_joints()));
    try {
      (void)robot_at_start(model, world);
    } catch (const std::runtime_error& e) {
      throw GenerationError(fmt::format("worlds.frozen: world {}: {}", index, e.what()));
    }
    if (log != nullptr) ++log->worlds;
    return world;
  }
  if (const auto* scenes = std::get_if<Scenes>(&data_->source)) {
    World world = scenes->make(model, index);
    if (log != nullptr) ++log->worlds;
    return world;
  }
  const Member& member = std::get<Mixture>(data_->source).at(index);
  const Making& making = data_->making;
  SceneBuilder builder(model, making.seed, index, {making.clearance, making.start_room}, moves);
  World world;
  bool found = false;
  int tries = 0;
  while (!found && tries < making.tries && !builder.hopeless()) {
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
      member.name, index, making.seed, model->name, tries, builder.worst_constraint()));
}

std::string Worlds::family_of(std::uint64_t index) const {
  if (const auto* frozen = std::get_if<Frozen>(&data_->source))
    return index < frozen->size() ? (*frozen)[index].family : std::string();
  if (const auto* scenes = std::get_if<Scenes>(&data_->source))
    return index < scenes->size() ? scenes->family_of(index) : std::string();
  return std::get<Mixture>(data_->source).at(index).name;
}

Json Worlds::identity(std::uint64_t index, const Moves& moves) const {
  if (!moves.empty()) {
    Json moved = identity(index);
    moved["moves"] = moma::to_json(moves);
    return moved;
  }
  if (const auto* frozen = std::get_if<Frozen>(&data_->source))
    return {{"frozen", index < frozen->size() ? moma::to_json((*frozen)[index]) : Json()}};
  if (const auto* scenes = std::get_if<Scenes>(&data_->source))
    return {{"scene", index < scenes->size() ? scenes->identity(index) : Json()}};
  const Member& member = std::get<Mixture>(data_->source).at(index);
  Json out{{"seed", data_->making.seed},
           {"index", index},
           {"clearance", data_->making.clearance},
           {"family", member.name},
           {"parameters", member.family->to_json()}};
  if (data_->making.start_room > 0.0) out["start_room"] = data_->making.start_room;
  return out;
}

std::vector<std::pair<std::string, double>> Worlds::shares() const {
  std::vector<std::pair<std::string, double>> out;
  const auto* mixture = std::get_if<Mixture>(&data_->source);
  if (mixture == nullptr) return out;
  double sum = 0.0;
  for (const Member& member : mixture->members) sum += member.weight;
  for (const Member& member : mixture->members)
    if (member.weight > 0.0) out.emplace_back(member.name, member.weight / sum);
  return out;
}

double Worlds::clearance() const { return data_->making.clearance; }

double Worlds::start_room() const { return data_->making.start_room; }

std::uint64_t Worlds::seed() const {
  if (const auto* frozen = std::get_if<Frozen>(&data_->source)) return frozen->front().seed;
  return data_->making.seed;
}

long long Worlds::size() const {
  if (const auto* frozen = std::get_if<Frozen>(&data_->source)) return static_cast<long long>(frozen->size());
  if (const auto* scenes = std::get_if<Scenes>(&data_->source)) return static_cast<long long>(scenes->size());
  return -1;
}

}  // namespace moma
