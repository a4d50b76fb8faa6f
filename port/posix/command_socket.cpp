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
    : loop_(loop), path_(std::move(path)), handler_(handler), log_(log), socket_(loop, *this) {}

CommandSocket::~CommandSocket() {
  for (Client& client : clients_) client.close();
  if (is_listening()) ::unlink(path_.c_str());
}

FileDescriptor CommandSocket::listen(const char*& failed) const {
  failed = "cannot listen";
  const std::optional<sockaddr_un> address = unix_address(path_);
  if (!address) {
    errno = ENAMETOOLONG;
    return {};
  }
  FileDescriptor socket = unix_socket();
  if (!socket.is_open()) return {};
  if (is_left_behind(*address)) ::unlink(path_.c_str());
  if (::bind(socket.get(), as_native(*address), sizeof(*address)) != 0) return {};
  // Before anybody can connect.
  if (::chmod(path_.c_str(), S_IRUSR | S_IWUSR) != 0) {
    failed = "cannot keep others out";
    return {};
  }
  if (::listen(socket.get(), SOMAXCONN) != 0) return {};
  return socket;
}

FileDescriptor CommandSocket::try_to_listen() {
  const char* failed;
  FileDescriptor socket = listen(failed);
  const int error = errno;
  if (socket.is_open()) {
    if (std::exchange(is_told_, false)) log_.write(Level::info, "takes commands at " + path_);
  } else if (!std::exchange(is_told_, true)) {
    log_.write(Level::warning,
               "takes no commands: " + std::string(failed) + " at " + path_ + " (" +
                   std::strerror(error) + "); goes on, and tries again; " +
                   (is_out_of_descriptors(error)
                        ? descriptors_cure
                        : "look who has that path, or change `socket` of [control]"));
  }
  errno = error;
  return socket;
}

CommandSocket::Client* CommandSocket::free_place() {
  const auto place = std::find_if(clients_.begin(), clients_.end(),
                                  [](const Client& client) { return !client.is_open(); });
  return place == clients_.end() ? nullptr : &*place;
}

// It is held while there is no place.
bool CommandSocket::accept_from(int listener) {
  FileDescriptor socket(::accept4(listener, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
  if (!socket.is_open()) return false;
  Client* const place = free_place();
  place->open(*this, static_cast<std::size_t>(place - clients_.data()), std::move(socket));
  if (free_place() == nullptr) socket_.hold();
  return true;
}

void CommandSocket::exhausted(const char* why) {
  log_.write(Level::error, "no further command can come at " + path_ + ": " + why + "; " +
                               descriptors_cure + ", or lower clients_max in [server] and [http]");
}

void CommandSocket::advance(Instant now) {
  now_ = now;
  socket_.advance(now);
  for (Client& client : clients_) {
    if (client.is_open() && client.active_at() + client_patience <= now) client.close();
  }
}

Instant CommandSocket::next_deadline() const {
  Instant deadline = socket_.next_deadline();
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
  owner_->socket_.resume();
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
