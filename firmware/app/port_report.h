// Says where something is served, once it is; and once why it is not, while its port cannot be had.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "etcm/port/log.h"
#include "etcm/port/socket_address.h"
#include "posix/acceptor.h"

namespace etcm::firmware {

struct PortMessages {
  std::string key;     // of the settings, which has the port: "`listen` of [http]"
  std::string served;  // before the address
  std::string missing;
};

class PortReport {
 public:
  // `acceptor` and `log` must outlive this.
  PortReport(const port::Acceptor& acceptor, PortMessages messages,
             std::vector<port::Network> allowed, port::Log& log)
      : acceptor_(acceptor),
        messages_(std::move(messages)),
        allowed_(std::move(allowed)),
        log_(log) {}

  void allow(std::vector<port::Network> networks) { allowed_ = std::move(networks); }
  void step();

 private:
  const port::Acceptor& acceptor_;
  const PortMessages messages_;
  std::vector<port::Network> allowed_;
  port::Log& log_;
  std::optional<bool> is_told_;
};

}  // namespace etcm::firmware
