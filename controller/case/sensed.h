#pragma once

#include <concepts>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "controller/config/read_described.h"
#include "controller/config/reader.h"
#include "controller/config/write_described.h"
#include "controller/describe/numbers.h"
#include "controller/model/robot_model.h"
#include "controller/step_described.h"

namespace moma {

// A case file holds what is sensed by its description (controller/step_described.h): a pose as `position` and
// `quaternion` or `rotation` among the other keys, matrices column by column, lists with a value for each joint or
// velocity. The goal and the objects of an observation have places of their own in the file.

/// A pose: `position`, and `quaternion` (w x y z) or `rotation` (a matrix, column by column). Unless it is `required`
/// the orientation may be left out.
Isometry read_pose(config::MapReader& in, bool required = true);
void write_pose(const Isometry& X, Json& json);

/// One number per name; the message lists the names, for the order is easy to get wrong.
VectorX read_named(const config::Node& node, const std::string& key, const std::vector<std::string>& names);

// Described matrices are covariances.
std::string accepted(Of<Matrix3>, const About& about);
void read_value(const config::Node& node, const std::string& key, Matrix3& value, const About& about);
template <std::same_as<Matrix3> M>  // and nothing that converts to one
Json write_value(const M& value, const About& /*about*/) {
  return std::vector<double>(value.data(), value.data() + 9);
}

namespace case_file {

/// True if a member stands among its record's keys; goals, what is carried and lists stand elsewhere.
template <class V>
inline constexpr bool is_here =
    !is_std_vector<V> && !std::is_same_v<V, GoalState> && !std::is_same_v<V, std::optional<GoalState>> &&
    !std::is_same_v<V, std::optional<Carried>>;

template <class T>
class Reading : public config::description::Reading<T> {
  using Base = config::description::Reading<T>;

 public:
  Reading(config::MapReader& in, const RobotModel& model, T& value) : Base(in, value, {}), model_(model) {}

  template <class P>
  void member(std::string_view name, P pointer, const About& about) {
    auto& value = this->value_.*pointer;
    config::MapReader& in = this->in_;
    using V = std::remove_cvref_t<decltype(value)>;
    if constexpr (numbers::is_pose<V>) {
      value = read_pose(in, about.required);
    } else if constexpr (NumberList<V>) {
      std::vector<std::string> names = model_.velocity_names();
      if (about.per == Per::kJoint) names.erase(names.begin(), names.begin() + model_.base_dof());
      if (about.required) in.require(name, (names.empty() ? "" : "one value each: ") + joined(names));
      value = VectorX::Zero(static_cast<Eigen::Index>(names.size()));
      if (const config::Node* node = in.get(name)) value = read_named(*node, in.key_of(name), names);
    } else if constexpr (is_here<V>) {
      Base::member(name, pointer, about);
    }
  }

 private:
  const RobotModel& model_;
};

template <class T>
class Writing : public config::description::Writing<T> {
  using Base = config::description::Writing<T>;

 public:
  using Base::Base;

  template <class P>
  void member(std::string_view name, P pointer, const About& about) {
    using V = std::remove_cvref_t<decltype(this->value_.*pointer)>;
    if constexpr (numbers::is_pose<V>)
      write_pose(this->value_.*pointer, this->json_);
    else if constexpr (is_here<V>)
      Base::member(name, pointer, about);
  }
};

}  // namespace case_file

/// Reads the members of an Observation, GoalState or ObjectState among the keys of a map.
template <class T>
void read_sensed(config::MapReader& in, const RobotModel& model, T& value) {
  case_file::Reading<T> reading(in, model, value);
  describe(reading, Of<T>{});
}

/// The keys that read_sensed() takes back to the same bits.
template <class T>
Json sensed_to_json(const T& value) {
  Json json = Json::object();
  const T otherwise{};
  case_file::Writing<T> writing(value, otherwise, json);
  describe(writing, Of<T>{});
  return json;
}

}  // namespace moma
