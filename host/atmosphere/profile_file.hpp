// Profile files: TOML text (docs/file-formats.md) or a sounding, read and checked into a ProfileSpec; and back to text.
#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "atmosphere/profile_spec.hpp"
#include "atmosphere/sounding.hpp"

namespace greenray {

/// The air described by `text`: TOML, or a sounding or CSV when it looks like one (then `choice` picks the ascent).
/// `file` names it in messages and gives the profile its name.
/// errors: InputError with every complaint at once, each at its line and column
ProfileSpec parse_profile(const std::string &file, std::string_view text, const SoundingChoice &choice = {});

/// A file (looked for below `relative_to_folder`, then below the working directory), else a shipped profile by name
/// ("us76", "profiles/us76.toml").
/// errors: InputError at `asked_at` when there is neither; as parse_profile otherwise
ProfileSpec load_profile(const std::string &name_or_file, const std::string &relative_to_folder,
                         const SourcePlace &asked_at, const SoundingChoice &choice = {});

/// TOML text from which parse_profile makes the same spec, every number to the last bit. Notes become comments.
std::string write_profile(const ProfileSpec &spec);

/// Names of the shipped profiles, sorted.
std::vector<std::string> shipped_profiles();

/// Whole contents of a file, or nothing if there is no such file.
/// errors: InputError at `asked_at` for a file that cannot be read or is over `max_bytes`
std::optional<std::string> file_contents(const std::string &path, std::size_t max_bytes, const SourcePlace &asked_at);

/// Words for [atmosphere] dispersion and the profile's `index`.
const std::vector<std::pair<const char *, IndexModel>> &index_model_words();

}  // namespace greenray
