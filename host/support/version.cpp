#include "support/version.hpp"

namespace greenray {
const char *version() { return GREENRAY_VERSION; }
}  // namespace greenray
