// The features of the site, whether each is in the mesh, and if not why and what to do, as JSON.
#pragma once

#include "firmware/status/document.h"
#include "firmware/status/status_sources.h"

namespace etcm::firmware {

class FeaturesDocument final : public Document {
 public:
  // `sources` must outlive this.
  explicit FeaturesDocument(const StatusSources& sources) : sources_(sources) {}
  bool write_next(Cursor& cursor, port::Instant asked_at, TextWriter& piece) const override;

 private:
  void write_feature(std::uint32_t number, TextWriter& piece) const;
  void write_reason(const FeatureRecord& feature, std::uint32_t number, TextWriter& piece) const;
  void write_blocker(const Blocker& blocker, TextWriter& piece) const;

  const StatusSources& sources_;
};

}  // namespace etcm::firmware
