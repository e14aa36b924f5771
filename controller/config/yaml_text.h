#pragma once

#include <string>

#include "controller/config/node.h"

namespace moma::config {

/// YAML of a node in block style, its lists and whatever is in them in flow style; the values keep their text.
std::string to_yaml(const Node& node, int indent = 0);

/// The same in one line, without a line break.
std::string to_flow_yaml(const Node& node);

/// Text as a scalar that reads back as this text: quoted where YAML would take it for something else.
std::string yaml_scalar(const std::string& text);

/// Text as comments: each line behind "# ".
std::string yaml_comment(const std::string& text);

}  // namespace moma::config
