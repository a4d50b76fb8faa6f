#include "firmware/app/port_report.h"

#include <string>

namespace etcm::firmware {

namespace {

std::string list_of(const std::vector<port::Network>& networks) {
  std::string list;
  for (const port::Network& network : networks) {
    list += (list.empty() ? "" : ", ") + to_string(network);
  }
  return list.empty() ? "nobody" : list;
}

}  // namespace

void PortReport::step() {
  if (is_told_ == acceptor_.is_listening()) return;
  is_told_ = acceptor_.is_listening();
  if (*is_told_) {
    log_.write(port::Level::info,
               messages_.served + to_string(acceptor_.address()) + " to " + list_of(allowed_));
  } else {
    log_.write(port::Level::error, messages_.missing + ": " + acceptor_.failure() + "; " +
                                       acceptor_.cure(messages_.key) +
                                       "; goes on, and tries again");
  }
}

}  // namespace etcm::firmware
