#pragma once

#include <sys/mount.h>

#include <filesystem>
#include <string>
#include <utility>

namespace moma::test {

/// A file system of its own with little room, mounted at a folder while it lives. Only root can make one: ask
/// mounted(), errno says why not.
class SmallDisk {
 public:
  SmallDisk(std::filesystem::path at, int kilobytes) : at_(std::move(at)) {
    std::filesystem::create_directories(at_);
    const std::string options = "size=" + std::to_string(kilobytes) + "k";
    mounted_ = mount("tmpfs", at_.c_str(), "tmpfs", 0, options.c_str()) == 0;
  }
  ~SmallDisk() {
    if (mounted_) umount2(at_.c_str(), MNT_DETACH);
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;

  bool mounted() const { return mounted_; }
  bool make_read_only() const { return mount("tmpfs", at_.c_str(), "tmpfs", MS_REMOUNT | MS_RDONLY, nullptr) == 0; }

 private:
  std::filesystem::path at_;
  bool mounted_ = false;
};

}  // namespace moma::test
