#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace moma::reports {

/// The page: one HTML document with its data, style and script inside.
std::string html(const nlohmann::ordered_json& page);

/// The page of `moma view`: its data comes from the server that it came from, and from nowhere else.
std::string served_html(const std::string& title);

/// JSON that may stand inside a <script>: pure ASCII but for what UTF-8 needs, without "<", bytes that are not
/// UTF-8 replaced.
std::string script_json(const nlohmann::ordered_json& json);

/// Text that may stand in an element.
std::string escape(std::string_view text);

}  // namespace moma::reports
