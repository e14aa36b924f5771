#include "controller/config/json_node.h"
#include "controller/config/text_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <span>

namespace moma::config {

Node node_from_json(const Json& json, const std::string& source) {
  Node node;
  node.mark.file = source;
  switch (json.type()) {
    case Json::value_t::object:
      node.kind = Node::Kind::kMap;
      for (const auto& [key, value] : json.items()) {
        node.entries.emplace_back(key, node_from_json(value, source));
        node.entries.back().second.key_mark.file = source;
      }
      break;
    case Json::value_t::array:
      node.kind = Node::Kind::kSequence;
      for (const auto& value : json) node.items.push_back(node_from_json(value, source));
      break;
    case Json::value_t::string:
      node.kind = Node::Kind::kScalar;
      node.scalar = json.get<std::string>();
      node.quoted = true;
      break;
    case Json::value_t::number_float:
      if (std::isnan(json.get<double>())) break;  // written as null
      [[fallthrough]];
    case Json::value_t::boolean:
    case Json::value_t::number_integer:
    case Json::value_t::number_unsigned:
      node.kind = Node::Kind::kScalar;
      node.scalar = json.dump();
      break;
    default:
      break;
  }
  return node;
}

Json number_to_json(double value) {
  if (std::isinf(value)) return value > 0 ? ".inf" : "-.inf";
  return value;
}

Json number_or_word(double value) {
  if (std::isnan(value)) return nullptr;
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  return value;
}

Json& as_object(Json& json) {
  if (json.is_null()) json = Json::object();
  return json;
}

Json node_to_json(const Node& node) {
  switch (node.kind) {
    case Node::Kind::kNull:
      return nullptr;
    case Node::Kind::kSequence: {
      Json list = Json::array();
      for (const Node& item : node.items) list.push_back(node_to_json(item));
      return list;
    }
    case Node::Kind::kMap: {
      Json map = Json::object();
      for (const auto& [key, value] : node.entries) map[key] = node_to_json(value);
      return map;
    }
    case Node::Kind::kScalar:
      break;
  }
  const std::string& text = node.scalar;
  if (node.quoted || text.empty()) return text;
  if (text == "true") return true;
  if (text == "false") return false;
  const char* begin = text.data();
  const char* end = begin + text.size();
  const char* first = begin + (*begin == '-' ? 1 : 0);
  if (first != end && ((*first >= '0' && *first <= '9') || *first == '.')) {
    long long whole = 0;
    if (const auto [stop, error] = std::from_chars(begin, end, whole); error == std::errc() && stop == end)
      return whole;
    double value = 0.0;
    if (const auto [stop, error] = std::from_chars(begin, end, value); error == std::errc() && stop == end)
      return value;
  }
  return text;
}

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

namespace description {

Json list_to_json(std::span<const double> values, bool one_for_all) {
  if (one_for_all && !values.empty() &&
      std::all_of(values.begin(), values.end(), [&](double v) { return v == values[0]; }))
    return number_to_json(values[0]);
  Json list = Json::array();
  for (const double value : values) list.push_back(number_to_json(value));
  return list;
}

}  // namespace description
}  // namespace moma::config
