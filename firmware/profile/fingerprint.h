// Whether what a device measured before is what it measures now.
#pragma once

#include <cstdint>

#include "firmware/profile/profile.h"

namespace etcm::firmware {

// A number that is another one, but for chance, where the reading has another name or unit, comes
// from other registers or is worked out in another way. The same on every machine; it is saved, so
// it stays the same from one version of the gateway to the next.
std::uint64_t fingerprint(const Profile& profile, const Profile::Reading& reading);

}  // namespace etcm::firmware
