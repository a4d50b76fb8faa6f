#include "svg.h"

#include <cmath>

namespace etcm::files {

TextSink& operator<<(TextSink& out, Grouped grouped) {
  std::size_t power = 1;
  while (grouped.number / power >= 1000) power *= 1000;
  out << grouped.number / power;
  for (power /= 1000; power > 0; power /= 1000) {
    const std::size_t three = grouped.number / power % 1000;
    out << "\xE2\x80\xAF" << three / 100 << three / 10 % 10 << three % 10;
  }
  return out;
}

TextSink& operator<<(TextSink& out, const Counted& counted) {
  return out << Grouped{counted.number} << ' '
             << (counted.number == 1 ? counted.one : counted.many);
}

TextSink& operator<<(TextSink& out, Escaped escaped) {
  for (const char c : escaped.text) {
    switch (c) {
      case '&':
        out << "&amp;";
        break;
      case '<':
        out << "&lt;";
        break;
      case '>':
        out << "&gt;";
        break;
      case '"':
        out << "&quot;";
        break;
      default:
        // A file name may hold any bytes; a picture may not.
        out << (escaped.is_utf8 || (c >= ' ' && c <= '~') ? c : '?');
    }
  }
  return out;
}

TextSink& operator<<(TextSink& out, Px length) {
  const std::int64_t hundredths = std::llround(length.value * 100);
  const std::int64_t magnitude = hundredths < 0 ? -hundredths : hundredths;
  if (hundredths < 0) out << '-';
  out << magnitude / 100;
  const std::int64_t rest = magnitude % 100;
  if (rest == 0) return out;
  out << (rest < 10 ? ".0" : ".");
  return out << (rest % 10 == 0 ? rest / 10 : rest);
}

TextSink& operator<<(TextSink& out, const Stroke& stroke) {
  return out << "stroke=\"" << stroke.colour << "\" stroke-width=\"" << Px{stroke.width * 100}
             << '"' << stroke.more;
}

}  // namespace etcm::files
