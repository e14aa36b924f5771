#pragma once

#include <filesystem>

namespace moma {

namespace fs = std::filesystem;

}  // namespace moma
