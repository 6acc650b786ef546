// --shard I/N, and the command line that a part file keeps for `greenray merge`.
#pragma once
#include <optional>

#include "cli/arguments.hpp"
#include "render/picture_part.hpp"

namespace greenray::cli {

/// errors: InputError if --shard is not I/N with 1 <= I <= N <= PictureShare::most
std::optional<PictureShare> share_from(const Arguments &arguments);

/// The words of `greenray render` that matter for the picture: without output, share, device and talk.
std::vector<std::string> words_without_share(const Arguments &arguments);

/// "wrote ...", or JSON.
void tell_share(const Arguments &arguments, const PictureShare &share, const std::filesystem::path &part,
                int resumed_at);

/// What killed runs left beside a picture's files (render/room_checkpoint.hpp).
void remove_stale_outputs(const std::filesystem::path &exr);

}  // namespace greenray::cli
