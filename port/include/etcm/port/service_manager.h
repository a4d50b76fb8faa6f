// What started the gateway and supervises it.
#pragma once

#include <cstdint>
#include <string_view>

#include "etcm/port/clock.h"

namespace etcm::port {

enum class ServiceEvent : std::uint8_t { ready, reloading, stopping, alive };

class ServiceManager {
 public:
  virtual void tell(ServiceEvent event) = 0;
  // One line for whoever asks how the gateway is.
  virtual void tell_status(std::string_view line) = 0;

  // A gateway that is not `alive` for so long is ended and started anew; zero: it is not watched.
  virtual Duration watchdog_timeout() const = 0;

 protected:
  ~ServiceManager() = default;
};

}  // namespace etcm::port
