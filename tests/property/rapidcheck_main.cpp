// RapidCheck's cases are the same each day, unless RC_PARAMS asks for others.
#include <gmock/gmock.h>

#include <cstdlib>
#include <string>

#include "support/emulated.h"

int main(int argc, char** argv) {
  const int cases = 100 / etcm::test::thinning_if_slow;
  const std::string parameters = "seed=20150720 max_success=" + std::to_string(cases);
  setenv("RC_PARAMS", parameters.c_str(), 0);
  testing::InitGoogleMock(&argc, argv);
  return RUN_ALL_TESTS();
}
