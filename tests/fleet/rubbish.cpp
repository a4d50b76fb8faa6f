#include "rubbish.h"

#include <iterator>

namespace etcm::test {

ModelMessage rubbish(const std::map<std::string, std::string>& retained, Random& random) {
  ModelMessage message{
      .topic = "etcm/v1/yard/stranger/node/0000000" + std::to_string(random.below(10)),
      .payload = "{}",
      .is_retained = random.below(3) != 0};
  if (!retained.empty() && random.below(5) != 0) {
    auto at = retained.begin();
    std::advance(at, static_cast<std::ptrdiff_t>(random.index(retained.size())));
    message.topic = at->first;
    message.payload = at->second;
  }
  std::string& text = message.payload;
  switch (random.below(5)) {
    case 0:
      text.resize(random.index(text.size() + 1));
      break;
    case 1:
      for (int i = 0; i < 3; ++i) {
        text[random.index(text.size())] = static_cast<char>(random.below(256));
      }
      break;
    case 2:
      text = std::string(1 + random.index(3000), '[');
      break;
    case 3:
      text = R"({"serial":99999999999999999999,"owner":5,"x":1e999})";
      break;
    default:
      text = random.below(2) == 0 ? "" : "null";
  }
  return message;
}

}  // namespace etcm::test
