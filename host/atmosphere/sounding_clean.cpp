// From rows as printed to levels a profile can use: drop, check the order, rebuild heights, convert. Each kind of
// repair leaves one note; what cannot be repaired is an error at its row.
#include <algorithm>
#include <cmath>

#include "atmosphere/sounding_parts.hpp"

namespace greenray::sounding {
namespace {

constexpr double gravity_m_s2 = 9.80665;          // standard; makes geopotential metres
constexpr double dry_air_J_kg_K = 287.053;        // 8.31446 / 0.0289652
constexpr double effective_radius_m = 6356766.0;  // US Standard Atmosphere 1976, eq 18
constexpr double vapour_to_air_mass = 0.62198;
constexpr double printed_step_Pa = 15;  // archives print 0.1 hPa: neighbours can share a printed pressure ..
constexpr double printed_step_m = 1.5;  // .. or a printed height
constexpr double same_air_K = 2;        // repeated levels may differ by a sensor change, not by more

double geometric_m(double geopotential_m) {
  return effective_radius_m * geopotential_m / (effective_radius_m - geopotential_m);
}
double geopotential_m(double geometric) { return effective_radius_m * geometric / (effective_radius_m + geometric); }

/// Saturation vapour pressure over water [Pa]; source: Bolton 1980, Mon. Wea. Rev. 108, eq 10.
double saturation_Pa(double temperature_K) {
  const double celsius = std::max(temperature_K - 273.15, -120.0);
  return 611.2 * std::exp(17.67 * celsius / (celsius + 243.5));
}

double virtual_temperature_K(const RawLevel &row) {
  const double humidity = row.relative_humidity.value_or(0);
  const double vapour_Pa = std::min(humidity * saturation_Pa(*row.temperature_K), 0.5 * *row.pressure_Pa);
  return *row.temperature_K / (1 - vapour_Pa / *row.pressure_Pa * (1 - vapour_to_air_mass));
}

/// Geopotential metres from the pressure of `below` to that of `above`; negative if `above` is the lower one.
double thickness_m(const RawLevel &below, const RawLevel &above) {
  const double mean_K = 0.5 * (virtual_temperature_K(below) + virtual_temperature_K(above));
  return dry_air_J_kg_K * mean_K / gravity_m_s2 * std::log(*below.pressure_Pa / *above.pressure_Pa);
}

void note_count(ProfileSpec &profile, std::size_t n, const std::string &verb, const std::string &noun,
                const std::string &rest) {
  if (n) profile.notes.push_back(verb + " " + count_of(n, noun) + " " + rest);
}

std::string number_text(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

void drop_useless(const Family &family, std::vector<RawLevel> &rows, ProfileSpec &profile) {
  std::size_t below_ground = 0, no_temperature = 0, no_pressure = 0, no_place = 0;
  std::vector<RawLevel> kept;
  for (const RawLevel &row : rows) {
    if (!row.temperature_K && family.shows_below_ground && kept.empty() && row.height_m) ++below_ground;
    else if (!row.pressure_Pa && family.needs_pressure) ++no_pressure;
    else if (!row.temperature_K) ++no_temperature;
    else if (!row.pressure_Pa && !row.height_m) ++no_place;
    else kept.push_back(row);
  }
  rows.swap(kept);
  note_count(profile, below_ground, "dropped", "level", "below ground");
  note_count(profile, no_pressure, "dropped", "level", "without pressure");
  note_count(profile, no_temperature, "dropped", "level", "without temperature");
  note_count(profile, no_place, "dropped", "level", "without height and pressure");
}

/// The last height, pressure and temperature seen on the way up.
struct Below {
  std::optional<double> height_m, pressure_Pa;
  double temperature_K = 0;
  int line = 0;
};

/// True for a row that repeats the level below within the printed digits; throws if it stands in the wrong order.
bool repeats(const Source &source, const RawLevel &row, const Below &below) {
  const bool heights = row.height_m && below.height_m, pressures = row.pressure_Pa && below.pressure_Pa;
  const double rise_m = heights ? *row.height_m - *below.height_m : 0;
  const double fall_Pa = pressures ? *below.pressure_Pa - *row.pressure_Pa : 0;
  const std::string where = " (line " + std::to_string(below.line) + ")";
  const std::string hint = "levels must go up in the file's own order: is a row misplaced or damaged?";
  if (pressures && fall_Pa < 0)
    source.fail(row.line, row.pressure_column,
                "a pressure below the " + number_text(*below.pressure_Pa / 100) + " hPa of the level before" + where,
                number_text(*row.pressure_Pa / 100) + " hPa", hint);
  const std::string higher =
      "a height above the " + (heights ? number_text(*below.height_m) : "") + " m of the level before" + where;
  if (heights && rise_m < 0) source.fail(row.line, row.height_column, higher, number_text(*row.height_m) + " m", hint);
  const bool same_height = heights && rise_m < closest_levels_m, same_pressure = pressures && fall_Pa == 0;
  if (!same_height && !same_pressure) return false;
  const double scale_m = dry_air_J_kg_K * below.temperature_K / gravity_m_s2;
  if (same_pressure && rise_m > printed_step_Pa / *row.pressure_Pa * scale_m)
    source.fail(row.line, row.pressure_column,
                "a pressure below the " + number_text(*below.pressure_Pa / 100) + " hPa of the level before" + where,
                "the same, " + number_text(rise_m) + " m higher", hint);
  const bool far_in_pressure =
      pressures && fall_Pa / *row.pressure_Pa * scale_m > printed_step_m + scale_m * printed_step_Pa / *row.pressure_Pa;
  if (same_height && far_in_pressure)
    source.fail(row.line, row.height_column, higher, "the same at " + number_text(fall_Pa / 100) + " hPa less", hint);
  if (std::abs(*row.temperature_K - below.temperature_K) > same_air_K)
    source.fail(row.line, same_height ? row.height_column : row.pressure_column, "one temperature at each level",
                number_text(*row.temperature_K) + " K and " + number_text(below.temperature_K) + " K" + where, hint);
  return true;
}

void check_order(const Source &source, std::vector<RawLevel> &rows, ProfileSpec &profile) {
  std::vector<RawLevel> kept;
  Below below;
  for (const RawLevel &row : rows) {
    if (!kept.empty() && repeats(source, row, below)) continue;
    if (row.height_m) below.height_m = row.height_m;
    if (row.pressure_Pa) below.pressure_Pa = row.pressure_Pa;
    below.temperature_K = *row.temperature_K, below.line = row.line;
    kept.push_back(row);
  }
  note_count(profile, rows.size() - kept.size(), "dropped", "level",
             "repeating the height or pressure of the level before");
  rows.swap(kept);
}

void settle_humidity(const Source &source, std::vector<RawLevel> &rows, ProfileSpec &profile) {
  std::size_t derived = 0, clamped = 0, missing = 0;
  for (RawLevel &row : rows) {
    if (!row.relative_humidity && row.dew_point_K) {
      row.relative_humidity = saturation_Pa(*row.dew_point_K) / saturation_Pa(*row.temperature_K);
      if (*row.relative_humidity > 1.05)
        source.fail(row.line, 1,
                    "a dew point no higher than the temperature of " + number_text(*row.temperature_K) + " K",
                    number_text(*row.dew_point_K) + " K", "are the two columns swapped?");
      ++derived;
    }
    if (!row.relative_humidity) ++missing;
    else if (*row.relative_humidity > 1) row.relative_humidity = 1.0, ++clamped;
  }
  if (derived)
    profile.notes.push_back("computed the relative humidity of " + count_of(derived, "level") + " from the dew point");
  if (clamped)
    profile.notes.push_back("lowered the relative humidity of " + count_of(clamped, "level") +
                            " from above 100 % to 100 %");
  if (missing)
    profile.notes.push_back("relative humidity is missing at " + std::to_string(missing) + " of " +
                            count_of(rows.size(), "level"));
}

/// Rebuilt rows [begin, end) reached the given height of row `end`: shrink their steps to fit between the given ones.
void fit_between(const Source &source, std::vector<RawLevel> &rows, std::size_t begin, std::size_t end) {
  const double bottom_m = *rows[begin - 1].height_m, top_m = *rows[end].height_m;
  const double reached_m = *rows[end - 1].height_m;
  const double wanted_m = rows[end].pressure_Pa ? reached_m + thickness_m(rows[end - 1], rows[end]) : HUGE_VAL;
  if (wanted_m - top_m > 20 + 0.1 * (top_m - bottom_m))
    source.fail(rows[end].line, rows[end].height_column,
                "a height above the " + number_text(reached_m) + " m that the pressures below it give",
                number_text(top_m) + " m", "its height and its pressure do not belong together");
  const double shrink = (top_m - bottom_m) / (wanted_m - bottom_m);
  for (std::size_t i = begin; i < end; ++i) rows[i].height_m = bottom_m + (*rows[i].height_m - bottom_m) * shrink;
}

/* Missing heights from the hypsometric equation, upwards from the last known level; those below the first known one
   downwards from it. Heights are geopotential here. */
void rebuild_heights(const Source &source, std::vector<RawLevel> &rows, ProfileSpec &profile) {
  const std::size_t missing = static_cast<std::size_t>(
      std::count_if(rows.begin(), rows.end(), [](const RawLevel &row) { return !row.height_m; }));
  if (!missing) return;
  const auto is_anchor = [](const RawLevel &row) { return row.height_m && row.pressure_Pa; };
  const auto first = std::find_if(rows.begin(), rows.end(), is_anchor);
  if (first == rows.end())
    source.fail(rows.front().line, rows.front().height_column, "at least one level with height and pressure", "none",
                "the other heights are rebuilt from it");
  auto known = first;
  for (auto row = first; row != rows.begin();) {
    --row;
    if (!row->height_m) row->height_m = *known->height_m + thickness_m(*known, *row);
    if (is_anchor(*row)) known = row;
  }
  std::size_t anchor = static_cast<std::size_t>(first - rows.begin()), run = rows.size();  // run: first of the rebuilt
  for (std::size_t i = anchor + 1; i < rows.size(); ++i) {
    if (!rows[i].height_m) {
      rows[i].height_m = *rows[anchor].height_m + thickness_m(rows[anchor], rows[i]);
      run = std::min(run, i);
    } else {
      if (run < i && *rows[i].height_m <= *rows[i - 1].height_m) fit_between(source, rows, run, i);
      run = rows.size();
    }
    if (is_anchor(rows[i])) anchor = i;
  }
  note_count(profile, missing, "rebuilt", "height", "hydrostatically with virtual temperature");
}

void need_two(const Source &source, const std::vector<RawLevel> &rows, int line) {
  if (rows.size() >= 2) return;
  source.fail(line, 1, "at least 2 levels with temperature, pressure and height", rows.empty() ? "none" : "1",
              "is the file complete?");
}

}  // namespace

void clean_levels(const Source &source, const Family &family, std::vector<RawLevel> rows, int line,
                  ProfileSpec &profile) {
  drop_useless(family, rows, profile);
  check_order(source, rows, profile);
  need_two(source, rows, line);
  settle_humidity(source, rows, profile);
  const std::size_t given = static_cast<std::size_t>(
      std::count_if(rows.begin(), rows.end(), [](const RawLevel &row) { return row.height_m.has_value(); }));
  if (!family.geopotential)
    for (RawLevel &row : rows)
      if (row.height_m) row.height_m = geopotential_m(*row.height_m);
  rebuild_heights(source, rows, profile);
  const std::size_t before = rows.size();
  std::erase_if(rows, [](const RawLevel &row) { return *row.height_m < 0; });
  note_count(profile, before - rows.size(), "dropped", "level", "below sea level, where profiles begin");
  need_two(source, rows, line);
  if (family.geopotential)
    note_count(profile, given, "converted", "geopotential height", "to geometric height above sea level");

  profile.base_is_us76 = false;
  for (const RawLevel &row : rows) {
    const double height_m = geometric_m(*row.height_m);
    if (height_m > highest_height_m || (!profile.levels.empty() && height_m <= profile.levels.back().height_m))
      source.fail(row.line, row.height_column, "heights that ascend and end below 120000 m",
                  number_text(height_m) + " m", "this one was rebuilt from its pressure");
    profile.levels.push_back(
        {height_m, *row.temperature_K, row.pressure_Pa, row.relative_humidity, {source.file, row.line, 1}});
  }
  const RawLevel &lowest = rows.front();
  if (!lowest.pressure_Pa) return;
  const double depth_m = dry_air_J_kg_K * virtual_temperature_K(lowest) / gravity_m_s2;
  profile.surface_pressure_Pa = *lowest.pressure_Pa * std::exp(*lowest.height_m / depth_m);
  if (*lowest.height_m > 0)
    profile.notes.push_back("reduced the pressure of the lowest level at " +
                            number_text(geometric_m(*lowest.height_m)) + " m to " +
                            number_text(profile.surface_pressure_Pa / 100) + " hPa at 0 m");
}

}  // namespace greenray::sounding
