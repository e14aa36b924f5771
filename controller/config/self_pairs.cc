#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <random>
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
constexpr double kRowRange = 0.1;     // [m]

VectorX sample(const RobotModel& model, std::mt19937_64& engine) {
  VectorX q(model.num_joints());
  for (int i = 0; i < q.size(); ++i) {
    const auto [lower, upper] = drawn_range(model.joints[static_cast<std::size_t>(i)]);
    q[i] = lower + (upper - lower) * (static_cast<double>(engine() >> 11) * 0x1p-53);
  }
  return q;
}

std::string list_names(const RobotModel& model, const std::vector<SelfPair>& pairs) {
  std::string text;
  for (const SelfPair& pair : pairs) {
    text += (text.empty() ? "" : ", ") + model.shapes[static_cast<std::size_t>(pair.first)].name + " - " +
            model.shapes[static_cast<std::size_t>(pair.second)].name;
  }
  return text;
}

// The controlled joints that move `link`, from the tip's side.
std::vector<int> joints_of(const RobotModel& model, int link) {
  std::vector<int> joints;
  for (; link > 0; link = model.links[static_cast<std::size_t>(link)].parent)
    if (const int joint = model.links[static_cast<std::size_t>(link)].controlled; joint >= 0) joints.push_back(joint);
  return joints;
}

// Shapes of links with one joint or two between them often overlap, as wrists do; further apart it is a posture or a
// shape that is wrong.
bool far_in_chain(const RobotModel& model, const SelfPair& pair) {
  constexpr std::size_t kNear = 2;
  const std::vector<int> a = joints_of(model, model.shapes[static_cast<std::size_t>(pair.first)].link);
  const std::vector<int> b = joints_of(model, model.shapes[static_cast<std::size_t>(pair.second)].link);
  const auto apart = [](const std::vector<int>& some, const std::vector<int>& others) {
    return std::count_if(some.begin(), some.end(),
                         [&](int joint) { return std::find(others.begin(), others.end(), joint) == others.end(); });
  };
  return static_cast<std::size_t>(apart(a, b) + apart(b, a)) > kNear;
}

// Whether two joints or more between a link and one that it carries all slide along one line: what telescopes slides
// inside itself.
bool telescopes(const Kinematics& kinematics, const SelfPair& pair) {
  const RobotModel& model = kinematics.model();
  const int a = model.shapes[static_cast<std::size_t>(pair.first)].link;
  const int b = model.shapes[static_cast<std::size_t>(pair.second)].link;
  const int root = model.rigid_root(std::min(a, b));
  std::vector<Vector3> axes_W;
  for (int i = model.rigid_root(std::max(a, b)); i != root;) {
    const Link& link = model.links[static_cast<std::size_t>(i)];
    if (i == 0 || link.joint_type != JointType::kPrismatic) return false;
    axes_W.push_back(kinematics.X_WL(i).linear() * link.axis);
    i = model.rigid_root(link.parent);
  }
  constexpr double kParallel = 0.999;
  return axes_W.size() > 1 && std::all_of(axes_W.begin(), axes_W.end(), [&](const Vector3& axis_W) {
           return std::abs(axis_W.dot(axes_W.front())) > kParallel;
         });
}

// Distances of all pairs of `model` that are within `range` at q, by index of the pair.
class PairDistances {
 public:
  explicit PairDistances(const RobotModel& model)
      : model_(std::make_shared<RobotModel>(model)), kinematics_(model_), proximity_(model_) {}

  template <typename Visit>
  void visit(const VectorX& q, double range, Visit&& visit) {
    kinematics_.update(Vector3::Zero(), q);
    visit_near_pairs(proximity_, kinematics_, range, visit);
  }

 private:
  std::shared_ptr<const RobotModel> model_;
  Kinematics kinematics_;
  Proximity proximity_;
};

}  // namespace

bool can_move_against(const RobotModel& model, int link1, int link2) {
  return model.rigid_root(link1) != model.rigid_root(link2);
}

std::vector<SelfPair> movable_pairs(const RobotModel& model) {
  std::vector<SelfPair> pairs;
  const int count = static_cast<int>(model.shapes.size());
  for (int i = 0; i < count; ++i) {
    for (int j = i + 1; j < count; ++j) {
      const int a = model.shapes[static_cast<std::size_t>(i)].link;
      const int b = model.shapes[static_cast<std::size_t>(j)].link;
      const bool adjacent =
          model.links[static_cast<std::size_t>(a)].parent == b || model.links[static_cast<std::size_t>(b)].parent == a;
      if (!adjacent && can_move_against(model, a, b)) pairs.push_back({i, j, true});
    }
  }
  return pairs;
}

std::vector<SelfPair> find_self_pairs(const RobotModel& source, double stop, std::vector<std::string>& notes,
                                      std::vector<std::string>& warnings) {
  RobotModel model = source;
  std::vector<SelfPair> sliding;
  const Kinematics at_ready(std::make_shared<const RobotModel>(source));
  for (const SelfPair& pair : movable_pairs(source))
    (telescopes(at_ready, pair) ? sliding : model.self_pairs).push_back(pair);

  std::vector<bool> touching(model.self_pairs.size(), false);
  PairDistances(model).visit(model.ready, 0.0, [&](std::size_t k, double) { touching[k] = true; });
  std::vector<SelfPair> candidates;
  std::vector<SelfPair> in_touch;
  for (std::size_t k = 0; k < touching.size(); ++k)
    (touching[k] ? in_touch : candidates).push_back(model.self_pairs[k]);
  model.self_pairs = std::move(candidates);

  std::vector<int> close(model.self_pairs.size(), 0);
  std::vector<bool> near(model.self_pairs.size(), false);
  PairDistances distances(model);
  std::mt19937_64 engine(1);
  for (int s = 0; s < kSamples; ++s) {
    distances.visit(sample(model, engine), kRowRange, [&](std::size_t k, double d) {
      near[k] = true;
      if (d < stop) ++close[k];
    });
  }
  std::vector<SelfPair> kept;
  std::vector<SelfPair> always_close;
  for (std::size_t k = 0; k < close.size(); ++k) {
    SelfPair pair = model.self_pairs[k];
    pair.row = near[k];
    (close[k] >= kAlwaysClose * kSamples ? always_close : kept).push_back(pair);
  }
  if (!sliding.empty())
    notes.push_back("self-collision: left out, sliding along one line: " + list_names(model, sliding));
  if (!in_touch.empty())
    notes.push_back("self-collision: left out, in touch at `ready`: " + list_names(model, in_touch));
  std::vector<SelfPair> wrong;
  std::copy_if(in_touch.begin(), in_touch.end(), std::back_inserter(wrong),
               [&](const SelfPair& pair) { return far_in_chain(source, pair); });
  if (!wrong.empty()) {
    warnings.push_back("self-collision: these touch at `ready`, so that their contacts never count: " +
                       list_names(model, wrong) + "; is `arm.ready` or a shape wrong?");
  }
  if (!always_close.empty())
    notes.push_back("self-collision: left out, close in most configurations: " + list_names(model, always_close));
  return kept;
}

}  // namespace moma::config
