#include "world/scenario/family.h"

namespace moma {
namespace {

/// Goals anywhere reachable around the robot, no obstacles.
class OpenFamily final : public Family {
 public:
  explicit OpenFamily(config::MapReader& in) { placement_.read(in); }

  nlohmann::ordered_json to_json() const override {
    nlohmann::ordered_json out;
    placement_.write(out);
    return out;
  }

  bool build(SceneBuilder& builder, World& world) const override { return builder.place_robot(placement_, world); }

 private:
  Placement placement_;
};

}  // namespace

std::unique_ptr<const Family> read_open(config::MapReader& in) { return std::make_unique<OpenFamily>(in); }

}  // namespace moma
