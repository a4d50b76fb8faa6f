// Looks at what a broker sends before libmosquitto sees it: lets pass sound packets of the kinds
// and sizes that a client of ours is to expect, and nothing else.
//
// libmosquitto 2.0.11 takes memory for whatever length a packet claims, up to 256 MiB, ends the
// whole program at a property that it does not know, and has code for kinds that were never asked
// for. A broker that is broken or hostile ends here.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace etcm::port {

class PacketGuard {
 public:
  // No packet with a message may be larger, its header included.
  explicit PacketGuard(std::uint32_t packet_bytes_max) : packet_bytes_max_(packet_bytes_max) {}

  // The next bytes of the stream. False: they must not be passed on, and nor may what follows.
  bool pass(std::span<const std::uint8_t> bytes);

  const char* why() const { return why_; }
  // Of the bytes that were passed: packets that begin in them.
  std::size_t packets_begun() const { return begun_; }

 private:
  // What is read next.
  enum class Part : std::uint8_t {
    head,
    length,
    skip,         // so many bytes of any value
    text_length,  // of a text, in two bytes
    varint,       // of any value
    zero,
    properties,  // their length
    property,    // its number
    rest,        // any bytes, to the end of the packet
    end,         // nothing more
  };

  bool take(std::uint8_t byte);
  bool take_head(std::uint8_t head);
  bool take_length(std::uint8_t byte);
  bool check_length();
  bool take_property(std::uint8_t number);
  std::size_t take_many(std::size_t available);
  bool count(std::uint32_t bytes);
  bool advance();
  Part next_of_packet();
  bool start_skip(std::uint32_t bytes);
  bool refuse(const char* why);

  const std::uint32_t packet_bytes_max_;
  Part part_ = Part::head;
  std::uint8_t head_ = 0;
  bool is_greeted_ = false;      // by CONNACK
  std::uint32_t left_ = 0;       // of the packet, behind its header
  std::uint32_t number_ = 0;     // that is being read
  unsigned number_bytes_ = 0;    // of it, read already
  unsigned step_ = 0;            // of those that packets of its kind have
  std::uint32_t skip_ = 0;       // bytes to be skipped
  unsigned texts_ = 0;           // to be skipped behind them
  bool has_properties_ = false;  // whose end is not reached
  std::uint32_t properties_left_ = 0;
  std::size_t begun_ = 0;
  const char* why_ = "";
};

}  // namespace etcm::port
