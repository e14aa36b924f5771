#include "controller/config/yaml_text.h"

#include <algorithm>
#include <cctype>
#include <sstream>

namespace moma::config {
namespace {

std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("''") : std::string(1, c);
  return result + "'";
}

// Plain scalars stay as they are; what YAML would read otherwise is quoted.
std::string scalar_text(const Node& node) {
  if (!node.quoted) return node.scalar.empty() ? "''" : node.scalar;
  return quoted(node.scalar);
}

}  // namespace

std::string to_flow_yaml(const Node& node) {
  switch (node.kind) {
    case Node::Kind::kNull:
      return "null";
    case Node::Kind::kScalar:
      return scalar_text(node);
    case Node::Kind::kSequence: {
      std::string text = "[";
      for (const Node& item : node.items) text += (text.size() > 1 ? ", " : "") + to_flow_yaml(item);
      return text + "]";
    }
    case Node::Kind::kMap: {
      std::string text = "{";
      for (const auto& [key, value] : node.entries)
        text += (text.size() > 1 ? ", " : "") + key + ": " + to_flow_yaml(value);
      return text + "}";
    }
  }
  return "";
}

std::string to_yaml(const Node& node, int indent) {
  if (node.kind != Node::Kind::kMap) return to_flow_yaml(node) + "\n";
  std::string text;
  const std::string space(static_cast<std::size_t>(indent), ' ');
  for (const auto& [key, value] : node.entries) {
    const bool nested = value.kind == Node::Kind::kMap && !value.entries.empty();
    text += space + key + ":" + (nested ? "\n" + to_yaml(value, indent + 2) : " " + to_flow_yaml(value) + "\n");
  }
  return text;
}

std::string yaml_scalar(const std::string& text) {
  const auto plain = [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '-' || c == '.' || c == '/';
  };
  std::string lower = text;
  std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return std::tolower(c); });
  const bool word =
      !text.empty() && std::all_of(text.begin(), text.end(), plain) &&
      (std::isalpha(static_cast<unsigned char>(text[0])) != 0 || text[0] == '_' || text.starts_with("../"));
  const bool other = lower == "null" || lower == "true" || lower == "false" || lower == "yes" || lower == "no" ||
                     lower == "on" || lower == "off" || lower == "y" || lower == "n";
  return word && !other ? text : quoted(text);
}

std::string yaml_comment(const std::string& text) {
  std::string out, line;
  for (std::istringstream lines(text); std::getline(lines, line);) out += (line.empty() ? "#" : "# " + line) + "\n";
  return out;
}

}  // namespace moma::config
