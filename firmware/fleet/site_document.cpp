#include "firmware/fleet/site_document.h"

#include "firmware/fleet/fleet_hash.h"
#include "firmware/fleet/site_codec.h"

namespace etcm::firmware {

SiteVersion SiteDocument::version() const {
  return {.number = number, .hash = fnv_hash(encode_site_content(*this))};
}

std::string SiteDocument::name() const {
  return "the site of gateway '" + gateway + "', number " + std::to_string(number) + ",";
}

}  // namespace etcm::firmware
