// Why something that should be in the mesh is not.
#pragma once

#include <string>

#include "etcm/status.h"
#include "firmware/site/site_domain.h"

namespace etcm::firmware {

struct Rejection {
  constexpr Rejection() = default;  // none
  constexpr Rejection(Status by_mesh) : mesh(by_mesh) {}
  constexpr Rejection(DomainPlace by_domain) : domain(by_domain) {}

  Status mesh = Status::ok;
  DomainPlace domain = DomainPlace::inside;

  constexpr bool is_none() const { return mesh == Status::ok && domain == DomainPlace::inside; }
  friend constexpr bool operator==(const Rejection&, const Rejection&) = default;
};

// One sentence for a person: what is wrong and what to do.
const char* explain(const Rejection& rejection);
// Whether room or budget was too small.
bool is_want_of_room(const Rejection& rejection);

}  // namespace etcm::firmware
