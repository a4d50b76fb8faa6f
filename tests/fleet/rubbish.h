// What no member says: messages of a broker that were cut off or garbled, and what never was one.
#pragma once

#include <map>
#include <string>

#include "broker_model.h"

namespace etcm::test {

// Made from what a broker has retained, as a rule.
ModelMessage rubbish(const std::map<std::string, std::string>& retained, Random& random);

}  // namespace etcm::test
