#pragma once
namespace greenray {
/// "0.1.0", from CMakeLists.txt.
const char *version();
}  // namespace greenray
