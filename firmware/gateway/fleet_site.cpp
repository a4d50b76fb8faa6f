#include "firmware/gateway/fleet_site.h"

#include "etcm/port/utf8.h"
#include "firmware/config/shared_site.h"
#include "firmware/fleet/site_codec.h"

namespace etcm::firmware {

namespace {

constexpr std::size_t trouble_bytes_max = 600;

}  // namespace

FleetSite::FleetSite(Pointer own, port::ProjectionSource* projections, port::Log& log)
    : settings_(std::move(own)),
      projections_(projections),
      log_(log),
      is_shared_(settings_->mqtt->share == FleetShare::site),
      given_(settings_) {
  read_own();
}

void FleetSite::read_own() {
  own_.reset();
  unshared_.clear();
  if (!is_shared_ || !has_own_site(*settings_)) return;
  SiteDocument document = document_of(*settings_);
  document.number = 1;
  document.gateway = settings_->mqtt->name;
  std::string wrong;
  if (!decode_site(encode_site(document), wrong)) {
    unshared_ = "the site of this gateway cannot be shared: it " + wrong +
                "; draw its features with fewer positions";
    return;
  }
  own_ = std::move(document);
  own_hash_ = own_->version().hash;
}

FleetSite::Pointer FleetSite::restored(std::span<const std::byte> saved) {
  if (!is_shared_ || saved.empty()) return nullptr;
  const std::optional<SiteDocument> document = FleetMember::saved_site(saved);
  if (!document || is_own(document->version())) return nullptr;
  // Its own file has been changed since.
  if (own_ && document->gateway == settings_->mqtt->name) return nullptr;
  if (!take(*document).empty()) return nullptr;
  given_ = foreign_;
  return given_;
}

void FleetSite::begin(FleetMember& member, port::Instant now) {
  if (std::exchange(has_begun_, true)) return;
  if (own_) return member.set_site(*own_, false, now);
  member.clear_site(now);
}

void FleetSite::update_settings(Pointer own, FleetMember& member, port::Instant now) {
  has_begun_ = true;
  const std::optional<SiteDocument> before = std::exchange(own_, std::nullopt);
  settings_ = std::move(own);
  read_own();
  foreign_.reset();
  foreign_version_ = unfit_version_ = {};
  unfit_.clear();
  if (own_) {
    member.set_site(*own_, !before || before->version().hash != own_hash_, now);
  } else {
    member.clear_site(now);
  }
  member.retry_site(now);
}

std::string FleetSite::take(const SiteDocument& document) {
  const SiteVersion version = document.version();
  if (!is_shared_ || is_own(version)) return "";
  // What was saved of its own file, which has been changed since: that is the next one.
  if (!has_begun_ && own_ && document.gateway == settings_->mqtt->name) return "";
  if (foreign_ && foreign_version_.hash == version.hash) return "";
  std::string wrong;
  std::optional<Settings> next = with_site(*settings_, document, projections_, wrong);
  if (!next) return wrong;
  foreign_ = std::make_shared<const Settings>(std::move(*next));
  foreign_version_ = version;
  return "";
}

// Of other settings the site that holds may not be good any more.
bool FleetSite::is_fit(const SiteDocument& site, const SiteVersion& version) {
  if (version == unfit_version_) return false;
  unfit_ = take(site);
  if (unfit_.empty()) return true;
  unfit_version_ = version;
  unfit_ = site.name() + " holds no more here: " + unfit_;
  return false;
}

FleetSite::Pointer FleetSite::take_news(const FleetMember& member) {
  const SiteDocument* const site = member.site();
  const SiteVersion version = member.site_version();
  const bool is_foreign = is_shared_ && site != nullptr && !is_own(version);
  Pointer valid = is_foreign && is_fit(*site, version) ? foreign_ : settings_;
  if (valid == given_) return nullptr;
  given_ = std::move(valid);
  if (given_ == foreign_) {
    log_.write(port::Level::info,
               "fleet: " + site->name() + " holds: " + std::to_string(site->features.size()) +
                   " segments of features, " + std::to_string(site->anchors.size()) + " anchors");
  }
  return given_;
}

std::string FleetSite::difference(const FleetMember& member) const {
  const SiteDocument* const site = member.site();
  if (!own_ || site == nullptr || is_own(member.site_version())) return "";
  const std::string& path = settings_->site.path;
  const bool is_of_settings = path.empty() && !settings_->features.empty();
  return site->name() + " holds here too, and differs from this gateway's own, " +
         (is_of_settings ? "the [[feature]] of " + settings_->features.front().source
          : path.empty() ? settings_->site.source
                         : path) +
         "; take that out here, or copy the one of '" + site->gateway +
         "'; or change it and reload, and it holds for all, if etcm.acl lets '" +
         settings_->mqtt->name + "' write etcm/v1/" + settings_->mqtt->site + "/site";
}

const std::string& FleetSite::find_trouble(const FleetMember& member, const FleetStatus& status) {
  if (!is_shared_) return trouble_;
  std::string trouble = !unshared_.empty() ? unshared_ : unfit_;
  if (trouble.empty() && status.site_trouble.empty()) trouble = difference(member);
  if (trouble != told_ && !trouble.empty()) {
    log_.write(port::Level::warning, "fleet: " + trouble);
  }
  told_ = trouble;
  // The page has so much room for it.
  trouble_ = port::cut_utf8(trouble.empty() ? status.site_trouble : trouble, trouble_bytes_max);
  return trouble_;
}

}  // namespace etcm::firmware
