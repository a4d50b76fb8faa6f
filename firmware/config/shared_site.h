// The site of a fleet: what this gateway's own makes for the others, and theirs in place of its
// own.
#pragma once

#include <optional>
#include <string>

#include "etcm/port/projection.h"
#include "firmware/config/settings.h"
#include "firmware/fleet/site_document.h"

namespace etcm::firmware {

// The settings have a site file, features or anchors.
bool has_own_site(const Settings& settings);

// Its plane. Where on the earth that is says `crs`, or the place it is about.
DocumentPlane plane_of(const SiteSettings& site);
// The other way. None, and why, where its projection cannot be had.
std::optional<SitePlane> site_plane_of(const DocumentPlane& plane,
                                       port::ProjectionSource* projections, std::string& why);

// Without number and gateway. Names are cut to site_name_max bytes.
SiteDocument document_of(const Settings& settings);

// The settings with the site of the document in place of their own. It must be as good as a site
// file has to be, and in the same plane: who has no site file and no plane of its own in [site]
// takes that too, by `projections`, which may be null. None, and what is wrong and the cure, where
// it is not. O(site), and memory for a mesh of it.
std::optional<Settings> with_site(const Settings& settings, const SiteDocument& document,
                                  port::ProjectionSource* projections, std::string& wrong);

}  // namespace etcm::firmware
