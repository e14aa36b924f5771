#include "world/scenario/placement.h"

namespace moma {

void Placement::read(config::MapReader& in) {
  moma::read(in, "start_heading", start_heading);
  moma::read(in, "distance", distance, config::Range::non_negative());
  moma::read(in, "direction", direction);
  moma::read(in, "heading", heading);
  in.read("limit_margin", limit_margin, config::Range::non_negative());
  in.read("tip_height", tip_height);
  in.read("floor_clearance", floor_clearance, config::Range::non_negative());
  in.read("self_clearance", self_clearance, config::Range::non_negative());
}

void Placement::write(nlohmann::ordered_json& out) const {
  out["start_heading"] = start_heading.to_json();
  out["distance"] = distance.to_json();
  out["direction"] = direction.to_json();
  out["heading"] = heading.to_json();
  out["limit_margin"] = limit_margin;
  out["tip_height"] = tip_height;
  out["floor_clearance"] = floor_clearance;
  out["self_clearance"] = self_clearance;
}

}  // namespace moma
