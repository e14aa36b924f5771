#pragma once

#include <string>

#include "reports/render/json.h"

namespace moma::reports {

/// The page: one HTML document with its data, style and script inside.
std::string html(const Json& page);

/// The page of `moma view`, which requests its data from its own server and from no other.
std::string served_html(const std::string& title);

/// Returns JSON that is safe inside a <script>: valid UTF-8 (other bytes are replaced) without "<".
std::string script_json(const Json& json);

/// Returns `text` escaped for the content of an element.
std::string escape(std::string_view text);

}  // namespace moma::reports
