// ServiceManager for systemd: datagrams to the socket it names in the environment (sd_notify(3)).
//
// Not libsystemd, which would bring five libraries more into the process for one sendmsg(): the
// protocol is a promise of systemd, and its manual shows it.
#pragma once

#include <sys/socket.h>
#include <sys/un.h>

#include "etcm/port/service_manager.h"
#include "posix/file_descriptor.h"

namespace etcm::port {

class SystemdNotify final : public ServiceManager {
 public:
  // Takes NOTIFY_SOCKET, WATCHDOG_USEC and WATCHDOG_PID out of the environment, so that no child
  // speaks for the gateway. Where there is no such socket, it tells nobody.
  SystemdNotify();

  void tell(ServiceEvent event) override;
  void tell_status(std::string_view line) override;
  Duration watchdog_timeout() const override { return watchdog_timeout_; }

 private:
  void send(std::string_view message);

  FileDescriptor socket_;
  sockaddr_un address_{};
  socklen_t address_size_ = 0;
  Duration watchdog_timeout_{};
};

}  // namespace etcm::port
