#include "firmware/sparkplug/payload.h"

#include <pb_decode.h>
#include <pb_encode.h>

#include <algorithm>
#include <bit>
#include <stdexcept>

#include "etcm/port/utf8.h"
#include "sparkplug.pb.h"

namespace etcm::firmware::sparkplug {

namespace {

// What the specification calls datatypes, those that are in use here.
enum : std::uint32_t {
  type_int32 = 3,
  type_int64 = 4,
  type_double = 10,
  type_boolean = 11,
  type_string = 12
};

// Values of the property "Quality".
constexpr std::uint32_t quality_good = 192;
constexpr std::uint32_t quality_stale = 500;

constexpr std::string_view rebirth_name = "Node Control/Rebirth";

template <std::size_t size>
void copy_text(std::string_view text, char (&field)[size]) {
  const std::string_view fits = port::cut_utf8(text, size - 1);
  *std::copy(fits.begin(), fits.end(), field) = '\0';
}

std::uint32_t datatype_of(Kind kind) {
  switch (kind) {
    case Kind::int32:
      return type_int32;
    case Kind::int64:
      return type_int64;
    case Kind::real:
      return type_double;
    case Kind::yes_no:
      return type_boolean;
    case Kind::hex:
      return type_string;
  }
  return 0;
}

void set_value(const Value& value, etcm_sparkplug_Metric& out) {
  out.has_datatype = true;
  out.datatype = datatype_of(value.kind);
  if (value.is_null) {
    out.has_is_null = out.is_null = true;
    return;
  }
  switch (value.kind) {
    case Kind::int32:
      out.which_value = etcm_sparkplug_Metric_int_value_tag;
      out.value.int_value = static_cast<std::uint32_t>(value.bits);
      return;
    case Kind::int64:
      out.which_value = etcm_sparkplug_Metric_long_value_tag;
      out.value.long_value = value.bits;
      return;
    case Kind::real:
      out.which_value = etcm_sparkplug_Metric_double_value_tag;
      out.value.double_value = std::bit_cast<double>(value.bits);
      return;
    case Kind::yes_no:
      out.which_value = etcm_sparkplug_Metric_boolean_value_tag;
      out.value.boolean_value = value.bits != 0;
      return;
    case Kind::hex: {
      out.which_value = etcm_sparkplug_Metric_string_value_tag;
      constexpr int digits = 16;
      for (int i = 0; i < digits; ++i) {
        out.value.string_value[i] = "0123456789abcdef"[value.bits >> 4 * (digits - 1 - i) & 15];
      }
      out.value.string_value[digits] = '\0';
      return;
    }
  }
}

etcm_sparkplug_PropertyValue& add_property(std::string_view key, std::uint32_t type,
                                           etcm_sparkplug_Metric& out) {
  out.has_properties = true;
  copy_text(key, out.properties.keys[out.properties.keys_count++]);
  etcm_sparkplug_PropertyValue& value = out.properties.values[out.properties.values_count++];
  value.has_type = true;
  value.type = type;
  return value;
}

void add_quality(bool is_stale, etcm_sparkplug_Metric& out) {
  etcm_sparkplug_PropertyValue& value = add_property("Quality", type_int32, out);
  value.which_value = etcm_sparkplug_PropertyValue_int_value_tag;
  value.value.int_value = is_stale ? quality_stale : quality_good;
}

std::uint64_t time_of(std::int64_t since_1970_ms) {
  return static_cast<std::uint64_t>(std::max<std::int64_t>(since_1970_ms, 0));
}

etcm_sparkplug_Metric to_message(const Metric& metric) {
  etcm_sparkplug_Metric out = etcm_sparkplug_Metric_init_zero;
  out.has_timestamp = true;
  out.timestamp = time_of(metric.measured_ms);
  out.has_alias = metric.alias != 0;
  out.alias = metric.alias;
  set_value(metric.value, out);
  return out;
}

// Writes to the end of what has been written, and says how far that is now.
template <class Write>
std::size_t append(std::span<char> room, std::size_t size, Write write) {
  const std::span<char> rest = room.subspan(size);
  pb_ostream_t stream =
      pb_ostream_from_buffer(reinterpret_cast<pb_byte_t*>(rest.data()), rest.size());
  if (!write(stream)) throw std::length_error("a payload of Sparkplug does not fit its room");
  return size + stream.bytes_written;
}

std::size_t append_number(std::span<char> room, std::size_t size, std::uint32_t tag,
                          std::uint64_t number) {
  return append(room, size, [&](pb_ostream_t& stream) {
    return pb_encode_tag(&stream, PB_WT_VARINT, tag) && pb_encode_varint(&stream, number);
  });
}

std::size_t append_metric(std::span<char> room, std::size_t size,
                          const etcm_sparkplug_Metric& metric) {
  return append(room, size, [&](pb_ostream_t& stream) {
    return pb_encode_tag(&stream, PB_WT_STRING, etcm_sparkplug_Payload_metrics_tag) &&
           pb_encode_submessage(&stream, etcm_sparkplug_Metric_fields, &metric);
  });
}

// Of one metric of a command. What cannot be understood asks for nothing.
bool read_command(pb_istream_t* stream, const pb_field_t*, void** argument) {
  etcm_sparkplug_Command command = etcm_sparkplug_Command_init_zero;
  const bool is_sound = pb_decode(stream, etcm_sparkplug_Command_fields, &command);
  if (is_sound && command.name == rebirth_name && command.boolean_value) {
    *static_cast<bool*>(*argument) = true;
  }
  return is_sound || pb_read(stream, nullptr, stream->bytes_left);
}

}  // namespace

Value Value::whole(std::int32_t value) {
  return {.kind = Kind::int32, .bits = static_cast<std::uint32_t>(value)};
}
Value Value::count(std::uint32_t value) { return {.kind = Kind::int64, .bits = value}; }
Value Value::real(double value) {
  return {.kind = Kind::real, .bits = std::bit_cast<std::uint64_t>(value)};
}
Value Value::yes_no(bool value) { return {.kind = Kind::yes_no, .bits = std::uint64_t{value}}; }
Value Value::hex(std::uint64_t value) { return {.kind = Kind::hex, .bits = value}; }

void PayloadWriter::begin(std::int64_t sent_ms) {
  size_ = append_number(room_, 0, etcm_sparkplug_Payload_timestamp_tag, time_of(sent_ms));
}

void PayloadWriter::add_birth(const Metric& metric) {
  etcm_sparkplug_Metric out = to_message(metric);
  out.has_name = true;
  copy_text(metric.name, out.name);
  if (!metric.unit.empty()) {
    etcm_sparkplug_PropertyValue& value = add_property("engUnit", type_string, out);
    value.which_value = etcm_sparkplug_PropertyValue_string_value_tag;
    copy_text(metric.unit, value.value.string_value);
  }
  if (metric.value.is_stale) add_quality(true, out);
  size_ = append_metric(room_, size_, out);
}

void PayloadWriter::add_change(const Metric& metric, bool was_stale) {
  etcm_sparkplug_Metric out = to_message(metric);
  if (metric.value.is_stale || was_stale) add_quality(metric.value.is_stale, out);
  size_ = append_metric(room_, size_, out);
}

std::string_view PayloadWriter::finish(std::optional<std::uint8_t> sequence) {
  if (sequence) size_ = append_number(room_, size_, etcm_sparkplug_Payload_seq_tag, *sequence);
  return {room_.data(), size_};
}

bool asks_for_rebirth(std::string_view payload) {
  bool is_asked = false;
  etcm_sparkplug_Payload message = etcm_sparkplug_Payload_init_zero;
  message.metrics.funcs.decode = read_command;
  message.metrics.arg = &is_asked;
  pb_istream_t stream =
      pb_istream_from_buffer(reinterpret_cast<const pb_byte_t*>(payload.data()), payload.size());
  return pb_decode(&stream, etcm_sparkplug_Payload_fields, &message) && is_asked;
}

}  // namespace etcm::firmware::sparkplug
