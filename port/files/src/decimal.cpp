#include "etcm/files/decimal.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <vector>

#include "etcm/types.h"

namespace etcm::files {

namespace {

constexpr std::size_t text_max = 1000;
// Exponents beyond this say "huge" or "tiny" just as well, and cannot overflow when added.
constexpr std::int64_t exponent_max = 1'000'000'000;
constexpr std::int64_t zeros_max = 40;

bool is_digit(char c) { return c >= '0' && c <= '9'; }

}  // namespace

std::optional<Decimal> Decimal::parse(std::string_view text) {
  if (text.empty() || text.size() > text_max) return std::nullopt;
  Decimal value;
  std::size_t at = 0;
  if (text[at] == '+' || text[at] == '-') value.negative_ = text[at++] == '-';
  bool point = false;
  bool any_digit = false;
  for (; at < text.size(); ++at) {
    if (is_digit(text[at])) {
      any_digit = true;
      value.digits_ += text[at];
      if (point) --value.exponent_;
    } else if (text[at] == '.' && !point) {
      point = true;
    } else {
      break;
    }
  }
  if (!any_digit) return std::nullopt;
  if (at < text.size()) {
    if (text[at] != 'e' && text[at] != 'E') return std::nullopt;
    ++at;
    bool negative = false;
    if (at < text.size() && (text[at] == '+' || text[at] == '-')) negative = text[at++] == '-';
    if (at == text.size()) return std::nullopt;
    std::int64_t exponent = 0;
    for (; at < text.size(); ++at) {
      if (!is_digit(text[at])) return std::nullopt;
      exponent = std::min(exponent * 10 + (text[at] - '0'), exponent_max);
    }
    value.exponent_ += negative ? -exponent : exponent;
  }
  value.normalize();
  // Of digits with many zeros too, so that what is written reads back as the same.
  value.exponent_ = std::clamp(value.exponent_, -exponent_max, exponent_max);
  return value;
}

Decimal Decimal::of(std::int64_t value) {
  Decimal decimal;
  decimal.digits_ = std::to_string(value);
  if (decimal.digits_.front() == '-') {
    decimal.negative_ = true;
    decimal.digits_.erase(0, 1);
  }
  decimal.normalize();
  return decimal;
}

void Decimal::normalize() {
  const std::size_t last = digits_.find_last_not_of('0');
  if (last == std::string::npos) {
    *this = Decimal{};
    return;
  }
  exponent_ += static_cast<std::int64_t>(digits_.size() - 1 - last);
  digits_.erase(last + 1);
  digits_.erase(0, digits_.find_first_not_of('0'));
}

Decimal Decimal::rounded() const {
  if (is_integer()) return *this;
  const auto fraction_digits = static_cast<std::size_t>(-exponent_);
  Decimal whole;
  if (fraction_digits > digits_.size()) return whole;
  const std::size_t whole_digits = digits_.size() - fraction_digits;
  const bool up = digits_[whole_digits] >= '5';
  whole.digits_ = "0" + digits_.substr(0, whole_digits);
  whole.negative_ = negative_;
  if (up) {
    std::size_t at = whole.digits_.size() - 1;
    while (whole.digits_[at] == '9') whole.digits_[at--] = '0';
    ++whole.digits_[at];
  }
  whole.normalize();
  return whole;
}

std::optional<std::int64_t> Decimal::to_integer() const {
  if (!is_integer()) return std::nullopt;
  if (is_zero()) return 0;
  if (static_cast<std::int64_t>(digits_.size()) + exponent_ > 19) return std::nullopt;
  std::string text = negative_ ? "-" : "";
  text += digits_;
  text.append(static_cast<std::size_t>(exponent_), '0');
  std::int64_t value = 0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  if (result.ec != std::errc{}) return std::nullopt;
  return value;
}

double Decimal::to_double() const {
  if (is_zero()) return 0;
  const std::string text = (negative_ ? "-" : "") + digits_ + "e" + std::to_string(exponent_);
  double value = 0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  if (result.ec == std::errc::result_out_of_range) {
    const double limit = exponent_ > 0 ? std::numeric_limits<double>::infinity() : 0.0;
    return negative_ ? -limit : limit;
  }
  return value;
}

std::string Decimal::to_string() const {
  if (is_zero()) return "0";
  std::string text = negative_ ? "-" : "";
  const auto size = static_cast<std::int64_t>(digits_.size());
  if (exponent_ > zeros_max || exponent_ + size < -zeros_max) {
    return text + digits_ + "e" + std::to_string(exponent_);
  }
  if (exponent_ >= 0) {
    text += digits_;
    text.append(static_cast<std::size_t>(exponent_), '0');
  } else if (exponent_ + size > 0) {
    const auto whole = static_cast<std::size_t>(exponent_ + size);
    text += digits_.substr(0, whole) + "." + digits_.substr(whole);
  } else {
    text += "0.";
    text.append(static_cast<std::size_t>(-(exponent_ + size)), '0');
    text += digits_;
  }
  return text;
}

Decimal operator*(const Decimal& a, const Decimal& b) {
  std::vector<int> sum(a.digits_.size() + b.digits_.size(), 0);
  for (std::size_t i = a.digits_.size(); i-- > 0;) {
    int carry = 0;
    for (std::size_t j = b.digits_.size(); j-- > 0;) {
      const int cell = sum[i + j + 1] + (a.digits_[i] - '0') * (b.digits_[j] - '0') + carry;
      sum[i + j + 1] = cell % 10;
      carry = cell / 10;
    }
    sum[i] += carry;
  }
  Decimal product;
  for (const int digit : sum) product.digits_ += static_cast<char>('0' + digit);
  product.exponent_ = a.exponent_ + b.exponent_;
  product.negative_ = a.negative_ != b.negative_;
  product.normalize();
  return product;
}

void write_coordinate(TextSink& out, std::int64_t subunits) {
  if (subunits < 0) out << '-';
  const std::uint64_t magnitude = subunits < 0 ? 0 - static_cast<std::uint64_t>(subunits)
                                               : static_cast<std::uint64_t>(subunits);
  constexpr std::uint64_t unit = subunits_per_unit;
  out << magnitude / unit;
  std::uint64_t fraction = magnitude % unit;
  if (fraction == 0) return;
  out << '.';
  // Each step takes one factor 2 from the denominator, so it ends after at most 28 digits.
  while (fraction != 0) {
    fraction *= 10;
    out << static_cast<char>('0' + static_cast<char>(fraction / unit));
    fraction %= unit;
  }
}

std::string coordinate_text(std::int64_t subunits) { return text_of(write_coordinate, subunits); }

}  // namespace etcm::files
