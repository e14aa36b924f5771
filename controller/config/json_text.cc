#include "controller/config/json_text.h"

#include "controller/config/budget.h"
#include "controller/config/node.h"

namespace moma::config {

using Json = nlohmann::ordered_json;

Json parse_json(std::string_view text, const std::string& source) {
  const Mark mark{source, 0, 0};
  if (text.size() > kMaxTextBytes) fail(mark, "", "more than " + std::to_string(kMaxTextBytes >> 20U) + " MiB of JSON");
  const auto check_level = [&mark](int level, Json::parse_event_t event, const Json& /*value*/) {
    const bool opens = event == Json::parse_event_t::object_start || event == Json::parse_event_t::array_start;
    if (opens && level >= kMaxNesting)
      fail(mark, "", "nested more than " + std::to_string(kMaxNesting) + " levels deep");
    return true;
  };
  try {
    return Json::parse(text, check_level);
  } catch (const Json::exception& e) {
    fail(mark, "", std::string("not JSON: ") + e.what());
  }
}

}  // namespace moma::config
