#include "plugin/host/library.h"

#include <dlfcn.h>
#include <elf.h>
#include <fmt/format.h>
#include <link.h>
#include <xxhash.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <mutex>
#include <string_view>

#include "plugin/border.h"

namespace moma {
namespace {

std::string content_of(const fs::path& file) {
  std::error_code error;
  if (!fs::exists(file, error)) throw PluginError(fmt::format("no file {}", file.string()));
  if (!fs::is_regular_file(file, error)) throw PluginError(fmt::format("{} is not a file", file.string()));
  std::ifstream in(file, std::ios::binary);
  std::string content((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  if (!in.is_open() || in.bad()) throw PluginError(fmt::format("{} cannot be read", file.string()));
  return content;
}

// The loader maps what the program headers promise; a file that ends before (a copy broken off) would bring the process
// down, with a signal, when it is read.
bool cut_off(std::string_view content) {
  ElfW(Ehdr) header;
  if (content.size() < sizeof header) return false;  // the loader itself says what is wrong
  std::memcpy(&header, content.data(), sizeof header);
  if (std::memcmp(header.e_ident, ELFMAG, SELFMAG) != 0 || header.e_phentsize != sizeof(ElfW(Phdr))) return false;
  const auto beyond = [&](std::uint64_t offset, std::uint64_t size) {
    return offset > content.size() || size > content.size() - offset;
  };
  if (beyond(header.e_phoff, header.e_phnum * sizeof(ElfW(Phdr)))) return true;
  for (std::size_t i = 0; i < header.e_phnum; ++i) {
    ElfW(Phdr) part;
    std::memcpy(&part, content.data() + header.e_phoff + i * sizeof part, sizeof part);
    if (part.p_type == PT_LOAD && beyond(part.p_offset, part.p_filesz)) return true;
  }
  return false;
}

// dlerror() begins with the file's name where the file is at fault.
std::string loader_says(const fs::path& file) {
  const char* text = ::dlerror();
  std::string message = text != nullptr ? text : "the loader gives no reason";
  const std::string prefix = file.string() + ": ";
  return message.starts_with(prefix) ? message.substr(prefix.size()) : message;
}

template <typename Function>
Function* find(void* handle, const char* name) {
  if (void* const found = ::dlsym(handle, name)) return reinterpret_cast<Function*>(found);
  throw PluginError(fmt::format(
      "has no function {}: it is no plugin of moma (see plugin/moma_plugin.h; in C++ MOMA_PLUGIN of plugin/plugin.h)",
      name));
}

std::string digest_of(const std::string& content) {
  const XXH128_hash_t hash = XXH3_128bits(content.data(), content.size());
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

// Refuses a file that changed after this process loaded it, or while it did: the loader returns what it holds under a
// name already, whatever the file has become.
void check_code(const fs::path& file, const std::string& digest) {
  static std::mutex mutex;
  static std::map<fs::path, std::string> loaded;
  const std::scoped_lock lock(mutex);
  if (loaded.emplace(file, digest).first->second != digest || plugin_digest(file) != digest)
    throw PluginError("has changed since this process loaded it; start moma again to use the new one");
}

}  // namespace

std::string without_controls(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < ' ' || c == 0x7f; }, ' ');
  return text;
}

std::string plugin_digest(const fs::path& file) { return digest_of(content_of(file)); }

std::shared_ptr<const PluginLibrary> load_plugin(const fs::path& file) {
  auto library = std::make_shared<PluginLibrary>();
  std::error_code error;
  library->file = fs::weakly_canonical(file, error);
  if (error) library->file = fs::absolute(file);
  const std::string content = content_of(library->file);
  library->digest = digest_of(content);
  if (cut_off(content)) throw PluginError("the file is cut off: it ends before what it says it holds");
  void* handle = ::dlopen(library->file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle == nullptr) {
    throw PluginError(
        fmt::format("{} cannot be loaded as a shared library: {}", library->file.string(), loader_says(library->file)));
  }
  check_code(library->file, library->digest);

  const auto abi = find<decltype(moma_plugin_abi)>(handle, "moma_plugin_abi");
  std::uint32_t version = 0;
  if (plugin::thrown_by([&] { version = abi(); })) throw PluginError("moma_plugin_abi() throws");
  if (version != MOMA_PLUGIN_ABI) {
    throw PluginError(
        fmt::format("is made for version {} of the plugin interface, this moma has version {}: build it against {}",
                    version, MOMA_PLUGIN_ABI, "its plugin/moma_plugin.h"));
  }
  library->functions = {.open = find<decltype(moma_plugin_open)>(handle, "moma_plugin_open"),
                        .close = find<decltype(moma_plugin_close)>(handle, "moma_plugin_close"),
                        .start = find<decltype(moma_plugin_start)>(handle, "moma_plugin_start"),
                        .step = find<decltype(moma_plugin_step)>(handle, "moma_plugin_step"),
                        .stop = find<decltype(moma_plugin_stop)>(handle, "moma_plugin_stop")};
  return library;
}

}  // namespace moma
