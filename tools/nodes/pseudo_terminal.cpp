#include "pseudo_terminal.h"

#include <fcntl.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <system_error>

namespace etcm::nodes {

namespace {

[[noreturn]] void fail(const std::string& what) {
  throw std::system_error(errno, std::generic_category(), what);
}

}  // namespace

PseudoTerminal::PseudoTerminal(const std::string& path)
    : near_(::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)) {
  std::array<char, 64> name;
  if (!near_.is_open() || ::grantpt(near_.get()) != 0 || ::unlockpt(near_.get()) != 0 ||
      ::ptsname_r(near_.get(), name.data(), name.size()) != 0) {
    fail("cannot make a pseudo terminal");
  }
  path_ = name.data();
  far_ = port::FileDescriptor(::open(path_.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC));
  termios settings{};
  // Else what we write before anybody opens the other end would come back as an echo.
  if (!far_.is_open() || ::tcgetattr(far_.get(), &settings) != 0) fail(path_);
  ::cfmakeraw(&settings);
  if (::tcsetattr(far_.get(), TCSANOW, &settings) != 0) fail(path_);
  if (path.empty()) return;

  // A link that was left behind is replaced, a file of somebody's never.
  struct stat found {};
  if (::lstat(path.c_str(), &found) == 0 && S_ISLNK(found.st_mode)) ::unlink(path.c_str());
  if (::symlink(path_.c_str(), path.c_str()) != 0) fail("cannot make the link " + path);
  path_ = path;
  is_linked_ = true;
}

PseudoTerminal::~PseudoTerminal() {
  if (is_linked_) ::unlink(path_.c_str());
}

}  // namespace etcm::nodes
