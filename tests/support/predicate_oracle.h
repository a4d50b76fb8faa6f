// The predicates once more, in the plainest words: integers without a limit (GMP), no filter.
#pragma once

#include <gmpxx.h>

#include <array>
#include <cstddef>

#include "etcm/types.h"

namespace etcm_test {

// Keeps its big integers between calls: a test makes millions of them.
class PredicateOracle {
 public:
  int orient2d(const etcm::Point& a, const etcm::Point& b, const etcm::Point& c) {
    offset(0, a, c);
    offset(1, b, c);
    cross(result_, 0, 1);
    return sgn(result_);
  }

  // The sign of the determinant of rows (x, y, x^2 + y^2), relative to d.
  int incircle(const etcm::Point& a, const etcm::Point& b, const etcm::Point& c,
               const etcm::Point& d) {
    offset(0, a, d);
    offset(1, b, d);
    offset(2, c, d);
    result_ = 0;
    for (std::size_t row = 0; row < 3; ++row) {
      cross(minor_, (row + 1) % 3, (row + 2) % 3);
      lift_ = x_[row] * x_[row];
      lift_ += y_[row] * y_[row];
      lift_ *= minor_;
      result_ += lift_;
    }
    return sgn(result_);
  }

 private:
  void offset(std::size_t row, const etcm::Point& p, const etcm::Point& origin) {
    static_assert(sizeof(long) == sizeof p.x, "the oracle runs on 64-bit hosts");
    x_[row] = static_cast<long>(p.x);
    x_[row] -= static_cast<long>(origin.x);
    y_[row] = static_cast<long>(p.y);
    y_[row] -= static_cast<long>(origin.y);
  }

  void cross(mpz_class& out, std::size_t i, std::size_t j) const {
    out = x_[i] * y_[j];
    mpz_submul(out.get_mpz_t(), y_[i].get_mpz_t(), x_[j].get_mpz_t());
  }

  std::array<mpz_class, 3> x_, y_;
  mpz_class lift_, minor_, result_;
};

}  // namespace etcm_test
