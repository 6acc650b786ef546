// Files compiled into the binary by tools/embed.cmake: kernels/**, profiles/**, scenes/**, host/data/**.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace greenray {

/// Contents of an embedded file by its path in the source tree ("profiles/us76.toml"), or nothing.
std::optional<std::string_view> embedded_file(std::string_view path);

/// Paths of the embedded files below `folder` ("scenes/"), sorted.
std::vector<std::string> embedded_files(std::string_view folder);

}  // namespace greenray
