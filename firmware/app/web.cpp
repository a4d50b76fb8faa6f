#include "firmware/app/web.h"

#include <algorithm>

namespace etcm::firmware {

namespace {

PortMessages page_messages() {
  return {.key = "`listen` of [http]",
          .served = "shows the status page on http://",
          .missing = "there is no status page"};
}

}  // namespace

Web::Web(const HttpSettings& settings, const StatusSources& sources,
         port::ServiceCounters& counters, port::EventLoop& loop, port::Log& log)
    : log_(log),
      page_(sources, settings.clients_max),
      server_(loop, page_, {.listen = settings.listen, .clients_max = settings.clients_max},
              counters),
      report_(server_.acceptor(), page_messages(), settings.allow, log) {
  update(settings);
  report_.step();
}

void Web::update(const HttpSettings& settings) {
  server_.allow(settings.allow, log_, settings.allow_place);
  server_.expect_names(settings.names);
  report_.allow(settings.allow);
}

void Web::step(port::Instant now) {
  page_.advance(now);
  server_.advance(now);
  report_.step();
}

port::Instant Web::next_deadline() const {
  return std::min(page_.next_deadline(), server_.next_deadline());
}

}  // namespace etcm::firmware
