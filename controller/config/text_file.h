#pragma once

#include <filesystem>
#include <string>

namespace moma::config {

/// The whole of a plain file. What is not one (a folder, FIFO, device, socket) is never opened: reading it could block
/// or never end. Throws std::runtime_error, without the file's name: not there, no plain file, unreadable, longer than
/// kMaxTextBytes.
std::string read_text_file(const std::filesystem::path& file);

/// At most 200 bytes of a text, for messages.
std::string shortened(const std::string& text);

}  // namespace moma::config
