// The gateway in numbers, as Prometheus reads them (text format 0.0.4).
#pragma once

#include "firmware/status/document.h"
#include "firmware/status/status_sources.h"

namespace etcm::firmware {

inline constexpr const char* metrics_media_type = "text/plain; version=0.0.4; charset=utf-8";

class MetricsDocument final : public Document {
 public:
  MetricsDocument(const StatusSources& sources, const BusMeter& meter)
      : sources_(sources), meter_(meter) {}
  bool write_next(Cursor& cursor, port::Instant asked_at, TextWriter& piece) const override;

 private:
  const StatusSources& sources_;
  const BusMeter& meter_;
};

}  // namespace etcm::firmware
