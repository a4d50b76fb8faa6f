#include "etcm/files/error.h"

namespace etcm::files {

InputError::InputError(const std::string& file, std::size_t line, const std::string& message)
    : std::runtime_error(line == 0 ? file + ": " + message
                                   : file + ":" + std::to_string(line) + ": " + message) {}

}  // namespace etcm::files
