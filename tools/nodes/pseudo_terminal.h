// A pair of terminals instead of a serial cable: one end is ours, the other has a path.
#pragma once

#include <string>

#include "posix/file_descriptor.h"

namespace etcm::nodes {

class PseudoTerminal {
 public:
  // With a symbolic link at `path` to the other end, where `path` is not empty: a path that stays
  // while the system numbers terminals as it likes. Throws std::system_error.
  explicit PseudoTerminal(const std::string& path = {});
  ~PseudoTerminal();
  PseudoTerminal(const PseudoTerminal&) = delete;
  PseudoTerminal& operator=(const PseudoTerminal&) = delete;

  // Never blocks.
  int descriptor() const { return near_.get(); }

  // Where the other end is opened.
  const std::string& path() const { return path_; }

 private:
  port::FileDescriptor near_;
  port::FileDescriptor
      far_;  // held open, or near_ would be hung up on while the other end is not open
  std::string path_;
  bool is_linked_ = false;
};

}  // namespace etcm::nodes
