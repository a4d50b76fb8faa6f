#include "posix/command_socket.h"

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <optional>
#include <utility>

#include "posix/exhaustion.h"

namespace etcm::port {

namespace {

std::optional<sockaddr_un> unix_address(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof(address.sun_path)) return std::nullopt;
  std::memcpy(address.sun_path, path.c_str(), path.size() + 1);
  return address;
}

const sockaddr* as_native(const sockaddr_un& address) {
  return reinterpret_cast<const sockaddr*>(&address);
}

FileDescriptor unix_socket() {
  return FileDescriptor(::socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
}

// Nobody listens there any more.
bool is_left_behind(const sockaddr_un& address) {
  struct stat status {};
  if (::stat(address.sun_path, &status) != 0 || !S_ISSOCK(status.st_mode)) return false;
  const FileDescriptor probe = unix_socket();
  return ::connect(probe.get(), as_native(address), sizeof(address)) != 0 && errno == ECONNREFUSED;
}

}  // namespace

CommandSocket::CommandSocket(EventLoop& loop, std::string path, CommandHandler& handler, Log& log)
    : loop_(loop), path_(std::move(path)), handler_(handler), log_(log) {
  try_to_listen();
}

CommandSocket::~CommandSocket() {
  for (Client& client : clients_) client.close();
  if (!is_listening()) return;
  loop_.remove(socket_.get());
  ::unlink(path_.c_str());
}

const char* CommandSocket::listen() {
  const std::optional<sockaddr_un> address = unix_address(path_);
  if (!address) {
    errno = ENAMETOOLONG;
    return "cannot listen";
  }
  FileDescriptor socket = unix_socket();
  if (!socket.is_open()) return "cannot listen";
  if (is_left_behind(*address)) ::unlink(path_.c_str());
  if (::bind(socket.get(), as_native(*address), sizeof(*address)) != 0) return "cannot listen";
  // Before anybody can connect.
  if (::chmod(path_.c_str(), S_IRUSR | S_IWUSR) != 0) return "cannot keep others out";
  if (::listen(socket.get(), SOMAXCONN) != 0) return "cannot listen";
  socket_ = std::move(socket);
  return nullptr;
}

void CommandSocket::try_to_listen() {
  const char* const failure = listen();
  if (failure == nullptr) {
    loop_.add(socket_.get(), *this, free_place() != nullptr, false);
    if (std::exchange(is_told_, false)) log_.write(Level::info, "takes commands at " + path_);
    return;
  }
  if (std::exchange(is_told_, true)) return;
  const int error = errno;
  log_.write(Level::warning, "takes no commands: " + std::string(failure) + " at " + path_ + " (" +
                                 std::strerror(error) + "); goes on, and tries again; " +
                                 (is_out_of_descriptors(error)
                                      ? descriptors_cure
                                      : "look who has that path, or change `socket` of [control]"));
}

CommandSocket::Client* CommandSocket::free_place() {
  const auto place = std::find_if(clients_.begin(), clients_.end(),
                                  [](const Client& client) { return !client.is_open(); });
  return place == clients_.end() ? nullptr : &*place;
}

void CommandSocket::watch() {
  if (is_listening()) loop_.change(socket_.get(), !is_resting_ && free_place() != nullptr, false);
}

void CommandSocket::on_ready(bool, bool) {
  while (Client* const place = free_place()) {
    FileDescriptor socket(::accept4(socket_.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
    if (!socket.is_open()) {
      const int error = errno;
      if (!is_exhaustion(error)) break;
      is_resting_ = true;
      retry_at_ = now_ + retry_interval;
      if (!std::exchange(is_exhaustion_told_, true)) {
        log_.write(Level::error, "no further command can come at " + path_ + ": " +
                                     std::strerror(error) + "; " + descriptors_cure +
                                     ", or lower clients_max in [server] and [http]");
      }
      break;
    }
    is_exhaustion_told_ = false;
    place->open(*this, static_cast<std::size_t>(place - clients_.data()), std::move(socket));
  }
  watch();
}

void CommandSocket::advance(Instant now) {
  now_ = now;
  if (is_at_rest() && retry_at_ <= now) {
    retry_at_ = now + retry_interval;
    is_resting_ = false;
    if (is_listening()) {
      watch();
    } else {
      try_to_listen();
    }
  }
  for (Client& client : clients_) {
    if (client.is_open() && client.active_at() + client_patience <= now) client.close();
  }
}

Instant CommandSocket::next_deadline() const {
  Instant deadline = is_at_rest() ? retry_at_ : never;
  for (const Client& client : clients_) {
    if (client.is_open()) deadline = std::min(deadline, client.active_at() + client_patience);
  }
  return deadline;
}

void CommandSocket::Client::open(CommandSocket& owner, std::size_t number, FileDescriptor socket) {
  owner_ = &owner;
  number_ = number;
  socket_ = std::move(socket);
  active_at_ = owner.now_;
  is_answering_ = false;
  begin_ = size_ = 0;
  owner.loop_.add(socket_.get(), *this, true, false);
}

void CommandSocket::Client::close() {
  if (!is_open()) return;
  if (is_answering_) owner_->handler_.end(number_);
  owner_->loop_.remove(socket_.get());
  socket_.close();
  owner_->watch();
}

void CommandSocket::Client::on_ready(bool, bool) {
  active_at_ = owner_->now_;
  if (!is_answering_) take();
  if (is_open() && is_answering_) give();
}

void CommandSocket::Client::take() {
  while (true) {
    // A line that fills all is no command.
    if (size_ == buffer_.size()) return close();
    const ssize_t count = ::recv(socket_.get(), buffer_.data() + size_, buffer_.size() - size_, 0);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0 && errno == EAGAIN) return;
    if (count <= 0) return close();
    char* const begin = buffer_.data() + size_;
    size_ += static_cast<std::size_t>(count);
    char* const end = std::find(begin, buffer_.data() + size_, '\n');
    if (end == buffer_.data() + size_) continue;
    is_answering_ = true;
    owner_->handler_.begin(number_,
                           {buffer_.data(), static_cast<std::size_t>(end - buffer_.data())});
    begin_ = size_ = 0;
    owner_->loop_.change(socket_.get(), false, true);
    return;
  }
}

void CommandSocket::Client::give() {
  while (true) {
    if (begin_ == size_) {
      begin_ = 0;
      size_ = owner_->handler_.read(number_, buffer_);
      if (size_ == 0) return close();
    }
    const ssize_t sent =
        ::send(socket_.get(), buffer_.data() + begin_, size_ - begin_, MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0 && errno == EAGAIN) return;
    if (sent < 0) return close();
    begin_ += static_cast<std::size_t>(sent);
  }
}

}  // namespace etcm::port
