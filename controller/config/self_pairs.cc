#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "controller/config/robot_build.h"
#include "controller/model/kinematics.h"
#include "controller/model/sampling.h"

namespace moma::config {
namespace {

constexpr int kSamples = 1000;
constexpr double kAlwaysClose = 0.2;  // share of the samples
// Pairs are out of each other's reach if none of the samples is within `stop`, and this share within its multiple.
constexpr double kPassing = 0.02, kPassingRange = 1.5;
constexpr double kRowRange = 0.1;  // [m]
constexpr double kSame = 1e-6;     // largest difference of distances that no joint changes [m]

VectorX sample(const RobotModel& model, std::mt19937_64& engine) {
  VectorX q(model.num_joints());
  for (int i = 0; i < q.size(); ++i) {
    const auto [lower, upper] = drawn_range(model.joint(i));
    q[i] = lower + (upper - lower) * (static_cast<double>(engine() >> 11) * 0x1p-53);
  }
  return q;
}

std::string list_names(const RobotModel& model, const std::vector<SelfPair>& pairs) {
  return joined(pairs, [&](const SelfPair& pair) {
    return model.shape(pair.first).name + " - " + model.shape(pair.second).name;
  });
}

// The controlled joints that move a shape.
std::set<int> joints_of(const RobotModel& model, int shape) {
  std::set<int> joints;
  for (int link = model.shape(shape).link; link > 0; link = model.link(link).parent)
    if (const int joint = model.link(link).controlled; joint >= 0) joints.insert(joint);
  return joints;
}

// Shapes of links with one joint or two between them often overlap, as wrists do; further apart it is a posture or a
// shape that is wrong.
bool far_in_chain(const RobotModel& model, const SelfPair& pair) {
  constexpr std::size_t kNear = 2;
  const std::set<int> a = joints_of(model, pair.first), b = joints_of(model, pair.second);
  std::vector<int> between;
  std::set_symmetric_difference(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(between));
  return between.size() > kNear;
}

// Returns true if two or more joints between a link and one that it carries all slide along one line: telescopes slide
// inside themselves.
bool telescopes(const Kinematics& kinematics, const SelfPair& pair) {
  const RobotModel& model = kinematics.model();
  const int a = model.shape(pair.first).link, b = model.shape(pair.second).link;
  const int root = model.rigid_root(std::min(a, b));
  std::vector<Vector3> axes_W;
  for (int i = model.rigid_root(std::max(a, b)); i != root;) {
    const Link& link = model.link(i);
    if (i == 0 || link.joint_type != JointType::kPrismatic) return false;
    axes_W.push_back(kinematics.X_WL(i).linear() * link.axis);
    i = model.rigid_root(link.parent);
  }
  constexpr double kParallel = 0.999;
  return axes_W.size() > 1 && std::all_of(axes_W.begin(), axes_W.end(), [&](const Vector3& axis_W) {
           return std::abs(axis_W.dot(axes_W.front())) > kParallel;
         });
}

}  // namespace

bool can_move_against(const RobotModel& model, int link1, int link2) {
  return model.rigid_root(link1) != model.rigid_root(link2);
}

std::vector<SelfPair> movable_pairs(const RobotModel& model) {
  std::vector<SelfPair> pairs;
  const int count = static_cast<int>(model.shapes.size());
  for (int i = 0; i < count; ++i) {
    for (int j = i + 1; j < count; ++j) {
      const int a = model.shape(i).link, b = model.shape(j).link;
      const bool adjacent = model.link(a).parent == b || model.link(b).parent == a;
      if (!adjacent && can_move_against(model, a, b)) pairs.push_back({i, j, true});
    }
  }
  return pairs;
}

std::vector<SelfPair> find_self_pairs(const RobotModel& source, double stop, std::vector<std::string>& notes,
                                      std::vector<std::string>& warnings) {
  const auto model = std::make_shared<RobotModel>(source);
  Kinematics kinematics(model);
  std::vector<SelfPair> sliding;
  model->self_pairs.clear();
  for (const SelfPair& pair : movable_pairs(source))
    (telescopes(kinematics, pair) ? sliding : model->self_pairs).push_back(pair);

  Proximity proximity(model);
  const std::vector<SelfPair>& pairs = model->self_pairs;
  struct Seen {
    int near = 0, passing = 0, close = 0;  // samples within kRowRange, kPassingRange and `stop`
    double least = kRowRange, most = 0.0;  // distance [m]
    bool constant() const { return near == kSamples && most - least < kSame; }
    bool pass() const { return close == 0 && passing >= kPassing * kSamples; }
  };
  std::vector<Seen> seen(pairs.size());
  std::vector<bool> touching(pairs.size(), false);
  visit_near_pairs(proximity, kinematics, 0.0, [&](std::size_t k, double) { touching[k] = true; });
  std::mt19937_64 engine(1);
  for (int s = 0; s < kSamples; ++s) {
    kinematics.update(Vector3::Zero(), sample(source, engine));
    visit_near_pairs(proximity, kinematics, kRowRange, [&](std::size_t k, double d) {
      ++seen[k].near;
      if (d < stop) ++seen[k].close;
      if (d < kPassingRange * stop) ++seen[k].passing;
      seen[k].least = std::min(seen[k].least, d);
      seen[k].most = std::max(seen[k].most, d);
    });
  }
  std::vector<SelfPair> kept, in_touch, always_close, constant, wrong;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const bool often = seen[k].close >= kAlwaysClose * kSamples;
    (touching[k]          ? in_touch
     : often              ? always_close
     : seen[k].constant() ? constant
                          : kept)
        .push_back({pairs[k].first, pairs[k].second, seen[k].near > 0 && !seen[k].pass()});
  }
  // Paths keep as little as their start has, of any pair: a constant one would lower what they keep of all others.
  for (const auto& [left_out, why] : {std::pair{&sliding, "sliding along one line"},
                                      {&in_touch, "in touch at `ready`"},
                                      {&always_close, "close in most configurations"},
                                      {&constant, "no joint changes their distance"}})
    if (!left_out->empty())
      notes.push_back(std::string("self-collision: left out, ") + why + ": " + list_names(source, *left_out));
  std::copy_if(in_touch.begin(), in_touch.end(), std::back_inserter(wrong),
               [&](const SelfPair& pair) { return far_in_chain(source, pair); });
  if (!wrong.empty()) {
    warnings.push_back("self-collision: these touch at `ready`, so that their contacts never count: " +
                       list_names(source, wrong) + "; is `arm.ready` or a shape wrong?");
  }
  return kept;
}

}  // namespace moma::config
