#pragma once

#include <string>
#include <vector>

namespace moma::reports {

/// What the page's script does with packed bytes, written again here: base64, inflate. At most `most` bytes.
std::vector<unsigned char> unpacked(const std::string& text, std::size_t most);

}  // namespace moma::reports
