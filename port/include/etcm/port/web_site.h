// What a web server hands out.
//
// The content of an answer is made piece by piece, no faster than its reader takes it: a large one
// needs no memory of its own, and making it never holds up anything for long.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace etcm::port {

// An HTTP status line's number.
namespace web_status {
inline constexpr std::uint16_t ok = 200;
inline constexpr std::uint16_t not_found = 404;
inline constexpr std::uint16_t misdirected = 421;
inline constexpr std::uint16_t unavailable = 503;
}  // namespace web_status

struct WebAnswer {
  std::uint16_t status = web_status::ok;
  const char* media_type = "text/plain; charset=utf-8";  // lasts as long as the site
  // Of this path's content: where it is the same, so is the content. 0: may differ each time.
  std::uint64_t version = 0;
};

class WebSite {
 public:
  // Somebody asks for this path, which begins with '/', has no query and is decoded; it may hold
  // any bytes. `reader`, below the server's count of clients, is theirs alone until end().
  virtual WebAnswer begin(std::size_t reader, std::string_view path) = 0;

  // Writes the next bytes of the content and returns how many; 0 when there are no more. `out` has
  // room for at least one.
  virtual std::size_t read(std::size_t reader, std::span<char> out) = 0;

  // Comes once for each begin(), whether or not everything was read.
  virtual void end(std::size_t reader) = 0;

 protected:
  ~WebSite() = default;
};

}  // namespace etcm::port
