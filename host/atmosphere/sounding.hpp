// Balloon soundings from the archives people use, read into the levels of a profile.
#pragma once
#include <string>
#include <string_view>

#include "atmosphere/profile_spec.hpp"

namespace greenray {

/* Which sounding of a file is wanted; an empty member means any (the first that fits is taken, and a note says so).
   station: number or identifier as the file spells it (`72357`, `OUN`, `USM00072357`; upper or lower case)
   when:    `2024-06-21`, `2024-06-21T12`, `2024-06-21T23:02Z` (UTC): nominal hour first, release time second;
            or `#2`, the second sounding of the file. A Wyoming CSV names no nominal hour: it gets the main
            synoptic hour (00, 06, 12, 18 UTC) nearest to its first time stamp. */
struct SoundingChoice {
  std::string station;
  std::string when;
};

/// True for a Wyoming list (text or page) or CSV, an IGRA version 2 file, and a CSV with height_* or temperature_*
/// columns; also for files only this reader can explain: HTML pages, archives still packed, IGRA derived files.
bool looks_like_sounding(const std::string &file_name, std::string_view text);

/* Reads one sounding.
   file_name: for messages, the profile's name and the refusal of derived files;  text: the whole file
   returns:   base_is_us76 false, levels ascending in geometric height above sea level [m], temperature [K],
              pressure [Pa], relative humidity over water 0..1 (none where unknown), surface_pressure_Pa reduced
              to 0 m from the lowest level, and one note for each kind of repair
   errors:    InputError with one diagnostic, at the line and column of the first thing that is wrong
   source:    layouts as published by the University of Wyoming and by NOAA (IGRA version 2 data format) */
ProfileSpec read_sounding(const std::string &file_name, std::string_view text, const SoundingChoice &choice = {});

}  // namespace greenray
