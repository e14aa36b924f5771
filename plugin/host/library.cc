#include "plugin/host/library.h"

#include <dlfcn.h>
#include <elf.h>
#include <fmt/format.h>
#include <link.h>
#include <xxhash.h>

#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string_view>

namespace moma {
namespace {

namespace fs = std::filesystem;

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
void find(void* handle, const char* name, Function& function) {
  function = reinterpret_cast<Function>(::dlsym(handle, name));
  if (function == nullptr) {
    throw PluginError(fmt::format(
        "has no function {}: it is no plugin of moma (see plugin/moma_plugin.h; in C++ MOMA_PLUGIN of plugin/plugin.h)",
        name));
  }
}

struct Comparison {
  ElfW(Addr) base;
  std::string_view content;
  bool found = false;
  bool same = true;
};

// By their hashes: AddressSanitizer stops a memcmp over the gaps between a library's constants.
bool same_bytes(const void* first, const void* second, std::size_t size) {
  return XXH128_isEqual(XXH3_128bits(first, size), XXH3_128bits(second, size)) != 0;
}

// Segments that are never written to are in memory as they are in the file.
int compare(dl_phdr_info* info, std::size_t, void* data) {
  auto& c = *static_cast<Comparison*>(data);
  if (info->dlpi_addr != c.base) return 0;
  c.found = true;
  for (int i = 0; i < info->dlpi_phnum; ++i) {
    const ElfW(Phdr)& part = info->dlpi_phdr[i];
    if (part.p_type != PT_LOAD || (part.p_flags & PF_W) != 0 || (part.p_flags & PF_R) == 0) continue;
    const bool inside = part.p_offset <= c.content.size() && part.p_filesz <= c.content.size() - part.p_offset;
    c.same = c.same && inside &&
             same_bytes(reinterpret_cast<const void*>(c.base + part.p_vaddr), c.content.data() + part.p_offset,
                        part.p_filesz);
  }
  return 1;
}

// The loader gives back what it holds already under a name, whatever the file has become since.
void check_code(void* handle, const std::string& content) {
  link_map* map = nullptr;
  if (::dlinfo(handle, RTLD_DI_LINKMAP, &map) != 0) return;
  Comparison c{map->l_addr, content};
  ::dl_iterate_phdr(compare, &c);
  if (c.found && !c.same)
    throw PluginError("has changed since this process loaded it; start moma again to use the new one");
}

std::string digest_of(const std::string& content) {
  const XXH128_hash_t hash = XXH3_128bits(content.data(), content.size());
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

}  // namespace

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
  check_code(handle, content);

  decltype(&moma_plugin_abi) abi = nullptr;
  find(handle, "moma_plugin_abi", abi);
  std::uint32_t version = 0;
  try {
    version = abi();
  } catch (...) {
    throw PluginError("moma_plugin_abi() throws");
  }
  if (version != MOMA_PLUGIN_ABI) {
    throw PluginError(
        fmt::format("is made for version {} of the plugin interface, this moma has version {}: build it against {}",
                    version, MOMA_PLUGIN_ABI, "its plugin/moma_plugin.h"));
  }
  PluginFunctions& f = library->functions;
  decltype(&moma_plugin_open) open = nullptr;
  find(handle, "moma_plugin_open", open);
  f.open = open;
  find(handle, "moma_plugin_close", f.close);
  find(handle, "moma_plugin_start", f.start);
  find(handle, "moma_plugin_step", f.step);
  find(handle, "moma_plugin_stop", f.stop);
  return library;
}

}  // namespace moma
