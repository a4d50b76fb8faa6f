// What a picture is written in: numbers, texts, strokes and paths of SVG, the same bytes
// everywhere.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "etcm/files/picture.h"
#include "etcm/files/text_sink.h"

namespace etcm::files {

// With thin spaces between groups of three digits.
struct Grouped {
  std::size_t number;
};
TextSink& operator<<(TextSink& out, Grouped grouped);

struct Counted {
  std::size_t number;
  const char* one;
  const char* many;
};
TextSink& operator<<(TextSink& out, const Counted& counted);

// What the user wrote, as SVG wants it.
struct Escaped {
  const std::string& text;
  bool is_utf8 = false;  // without control characters
};
TextSink& operator<<(TextSink& out, Escaped escaped);

// A length in pixels with two decimals at most, the same text everywhere.
struct Px {
  double value;
};
TextSink& operator<<(TextSink& out, Px length);

struct Stroke {
  const char* colour;
  double width;
  const char* more = "";
};
TextSink& operator<<(TextSink& out, const Stroke& stroke);

// One path in relative moves, which are short; no path at all where nothing is drawn. `style`
// writes the attributes before the data.
template <class Style>
class Path {
 public:
  Path(TextSink& out, const Style& style) : out_(out), style_(style) {}
  Path(const Path&) = delete;
  Path& operator=(const Path&) = delete;
  ~Path() {
    if (command_ != ' ') out_ << "\"/>\n";
  }

  void move_to(PictureSpot to) {
    if (command_ == ' ') {
      out_ << "<path ";
      style_();
      out_ << " d=\"M";
    } else {
      out_ << 'm';
    }
    ends_in_digit_ = false;
    command_ = 'm';
    append(to);
    first_ = to;
  }
  void line_to(PictureSpot to) {
    if (command_ != 'l') {
      out_ << 'l';
      ends_in_digit_ = false;
    }
    command_ = 'l';
    append(to);
  }
  void close() {
    out_ << 'z';
    ends_in_digit_ = false;
    command_ = 'z';
    at_ = first_;
  }
  void dot(PictureSpot to) {
    move_to(to);
    // Not 0: some renderers draw no caps on a line without length.
    out_ << "h1";
    at_.x += 1;
  }

 private:
  void append(PictureSpot to) {
    const std::int64_t dx = to.x - at_.x;
    const std::int64_t dy = to.y - at_.y;
    if (ends_in_digit_ && dx >= 0) out_ << ' ';
    out_ << dx;
    if (dy >= 0) out_ << ' ';
    out_ << dy;
    ends_in_digit_ = true;
    at_ = to;
  }

  TextSink& out_;
  const Style& style_;
  PictureSpot at_;
  PictureSpot first_;
  char command_ = ' ';
  bool ends_in_digit_ = false;
};

}  // namespace etcm::files
