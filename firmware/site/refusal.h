// Why something that should be in the mesh is not.
#pragma once

#include <string>

#include "etcm/status.h"
#include "firmware/site/site_domain.h"

namespace etcm::firmware {

struct Refusal {
  constexpr Refusal() = default;  // none
  constexpr Refusal(Status by_mesh) : mesh(by_mesh) {}
  constexpr Refusal(DomainPlace by_domain) : domain(by_domain) {}

  Status mesh = Status::ok;
  DomainPlace domain = DomainPlace::inside;

  constexpr bool is_none() const { return mesh == Status::ok && domain == DomainPlace::inside; }
  friend constexpr bool operator==(const Refusal&, const Refusal&) = default;
};

// One sentence for a person: what is wrong and what to do.
const char* explain(const Refusal& refusal);
// Whether room or budget was too small.
bool is_want_of_room(const Refusal& refusal);

}  // namespace etcm::firmware
