#include "posix/listening_socket.h"

#include <cerrno>
#include <cstring>
#include <utility>

#include "posix/exhaustion.h"

namespace etcm::port {

ListeningSocket::ListeningSocket(EventLoop& loop, ListeningHandler& handler)
    : loop_(loop), handler_(handler) {
  try_to_listen();
}

ListeningSocket::~ListeningSocket() {
  if (is_listening()) loop_.remove(socket_.get());
}

void ListeningSocket::try_to_listen() {
  socket_ = handler_.try_to_listen();
  error_ = is_listening() ? 0 : errno;
  if (is_listening()) loop_.add(socket_.get(), *this, !is_held_, false);
}

void ListeningSocket::on_ready(bool, bool) {
  while (!is_held_) {
    if (handler_.accept_from(socket_.get())) {
      is_exhaustion_told_ = false;
      continue;
    }
    const int error = errno;
    if (!is_exhaustion(error)) return;
    is_resting_ = true;
    retry_at_ = now_ + retry_interval;
    watch();
    if (!std::exchange(is_exhaustion_told_, true)) handler_.exhausted(std::strerror(error));
    return;
  }
}

void ListeningSocket::watch() {
  if (is_listening()) loop_.change(socket_.get(), !is_held_ && !is_resting_, false);
}

void ListeningSocket::hold() {
  is_held_ = true;
  watch();
}

void ListeningSocket::resume() {
  if (!is_held_ && !is_resting_) return;
  is_held_ = is_resting_ = false;
  watch();
}

void ListeningSocket::advance(Instant now) {
  now_ = now;
  if (now < next_deadline()) return;
  retry_at_ = now + retry_interval;
  if (!is_listening()) return try_to_listen();
  is_resting_ = false;
  watch();
}

}  // namespace etcm::port
