// A small disk in memory, as long as it lives; needs the right to mount one.
#pragma once

#include <sys/mount.h>

#include <filesystem>
#include <string>

namespace etcm::port {

class MountedDisk {
 public:
  explicit MountedDisk(const std::string& path) : path_(path) {
    std::filesystem::create_directory(path);
    is_mounted = ::mount("none", path.c_str(), "tmpfs", 0, "size=64k") == 0;
  }
  MountedDisk(const MountedDisk&) = delete;
  MountedDisk& operator=(const MountedDisk&) = delete;
  ~MountedDisk() {
    if (is_mounted) ::umount2(path_.c_str(), MNT_DETACH);
  }
  // 0, or MS_RDONLY.
  bool remount(unsigned long flags) {
    return ::mount("none", path_.c_str(), "tmpfs", MS_REMOUNT | flags, "size=64k") == 0;
  }
  bool is_mounted = false;

 private:
  std::string path_;
};

}  // namespace etcm::port
