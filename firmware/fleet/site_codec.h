// The document of a site as JSON: schema/site.json.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "firmware/fleet/site_document.h"

namespace etcm::firmware {

// The content alone, in one way only: its hash is that of this text.
std::string encode_site_content(const SiteDocument& document);
std::string encode_site(const SiteDocument& document);

// None, and what is wrong with it, for what is not sound: then its hash is not that of its content,
// too.
std::optional<SiteDocument> decode_site(std::string_view payload, std::string& wrong);

}  // namespace etcm::firmware
