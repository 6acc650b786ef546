// Which sounding of a file: dates, stations, and the list a reader gets when nothing fits.
#include <algorithm>
#include <charconv>
#include <cstdio>

#include "atmosphere/sounding_parts.hpp"

namespace greenray::sounding {

std::optional<Moment> make_moment(int year, int month, int day, int minute) {
  if (year < 1 || year > 9999 || month < 1 || day < 1 || minute < -1 || minute >= 24 * 60) return std::nullopt;
  const std::chrono::year_month_day date{std::chrono::year{year}, std::chrono::month{static_cast<unsigned>(month)},
                                         std::chrono::day{static_cast<unsigned>(day)}};
  if (!date.ok()) return std::nullopt;
  return Moment{std::chrono::sys_days{date}, minute};
}

std::string moment_text(const Moment &moment) {
  const std::chrono::year_month_day date{moment.day};
  char text[64];
  std::snprintf(text, sizeof text, "%04d-%02u-%02u", static_cast<int>(date.year()), static_cast<unsigned>(date.month()),
                static_cast<unsigned>(date.day()));
  std::string shown = text;
  if (moment.minute < 0) return shown;
  std::snprintf(text, sizeof text, "T%02d:%02dZ", moment.minute / 60, moment.minute % 60);
  return shown + text;
}

std::string entry_text(const Entry &entry) {
  std::string text;
  for (const std::string &station : entry.stations) text.append(text.empty() ? "" : " ").append(station);
  const std::optional<Moment> &time = entry.nominal ? entry.nominal : entry.release;
  if (time) text.append(text.empty() ? "" : " ").append(moment_text(*time));
  return text;
}

namespace {

/// "2024-06-21T23:02Z" in parts; -1 where not said.
struct Wanted {
  Moment moment;
  bool with_minute = false;
};

/// Takes `digits` digits and then `separator` (if not 0) off the front; -1 if they are not there.
int take(std::string_view &text, std::size_t digits, char separator) {
  int value = -1;
  const std::string_view part = text.substr(0, digits);
  const bool all_digits =
      part.size() == digits && std::all_of(part.begin(), part.end(), [](char c) { return c >= '0' && c <= '9'; });
  if (!all_digits || (separator && (text.size() <= digits || text[digits] != separator))) return -1;
  std::from_chars(part.data(), part.data() + digits, value);
  text.remove_prefix(digits + (separator ? 1 : 0));
  return value;
}

std::optional<Wanted> parse_when(std::string_view text) {
  const int year = take(text, 4, '-');
  const int month = take(text, 2, '-');
  const int day = take(text, 2, 0);
  if (year < 0 || month < 0 || day < 0) return std::nullopt;
  Wanted wanted;
  int minute_of_day = -1;
  if (!text.empty()) {
    if (text.front() != 'T' && text.front() != 't' && text.front() != ' ') return std::nullopt;
    text.remove_prefix(1);
    const int hour = take(text, 2, 0);
    if (hour < 0 || hour > 23) return std::nullopt;
    int minute = 0;
    if (text.starts_with(':')) {
      text.remove_prefix(1);
      minute = take(text, 2, 0);
      if (minute < 0 || minute > 59) return std::nullopt;
      wanted.with_minute = true;
      if (text.starts_with(':')) {
        text.remove_prefix(1);
        if (const int second = take(text, 2, 0); second < 0 || second > 60) return std::nullopt;
      }
    }
    if (text == "Z" || text == "z") text = {};
    minute_of_day = hour * 60 + minute;
  }
  const std::optional<Moment> moment = make_moment(year, month, day, minute_of_day);
  if (!moment || !text.empty()) return std::nullopt;
  wanted.moment = *moment;
  return wanted;
}

bool fits(const std::optional<Moment> &time, const Wanted &wanted) {
  if (!time || time->day != wanted.moment.day) return false;
  if (wanted.moment.minute < 0) return true;
  if (time->minute < 0) return false;
  return wanted.with_minute ? time->minute == wanted.moment.minute : time->minute / 60 == wanted.moment.minute / 60;
}

/// WMO number inside an IGRA name (USM00072357 -> 72357); the name itself otherwise.
std::string station_key(const std::string &name) {
  const std::string key = lower_case(name);
  const bool igra_of_wmo = key.size() == 11 && key.substr(2, 4) == "m000";
  return igra_of_wmo ? key.substr(6) : key;
}

bool fits_station(const Entry &entry, const std::string &wanted) {
  return wanted.empty() || std::any_of(entry.stations.begin(), entry.stations.end(), [&](const std::string &station) {
           return station_key(station) == station_key(wanted);
         });
}

std::string list_of(const std::vector<Entry> &entries) {
  constexpr std::size_t most = 12;
  std::string text;
  for (std::size_t i = 0; i < std::min(entries.size(), most); ++i) {
    const Entry &entry = entries[i];
    const std::string name = entry_text(entry);
    text += (i ? ", #" : "#") + std::to_string(i + 1) + " " + (name.empty() ? "(no station, no date)" : name);
    if (entry.nominal && entry.nominal->minute < 0) text += " (hour unknown)";
    if (entry.nominal && entry.release) text += " (released " + moment_text(*entry.release) + ")";
  }
  if (entries.size() > most) text += " and " + std::to_string(entries.size() - most) + " more";
  return text;
}

}  // namespace

/// Indices of the entries that fit; nominal times are preferred to release times.
static std::vector<std::size_t> fitting(const Source &source, const std::vector<Entry> &entries,
                                        const SoundingChoice &choice) {
  std::optional<Wanted> wanted;
  std::size_t index = 0;
  const std::string_view when = trimmed(choice.when);
  if (when.starts_with('#')) {
    const auto [end, error] = std::from_chars(when.data() + 1, when.data() + when.size(), index);
    if (error != std::errc{} || end != when.data() + when.size()) index = entries.size() + 1;
  } else if (!when.empty()) {
    wanted = parse_when(when);
    if (!wanted)
      source.fail(1, 1, "a time like 2024-06-21T12, 2024-06-21T23:02Z or #2 for the choice of sounding", quoted(when),
                  "times are UTC");
  }
  std::vector<std::size_t> by_nominal, by_release;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (!fits_station(entries[i], choice.station)) continue;
    if (wanted && fits(entries[i].release, *wanted)) by_release.push_back(i);
    if (wanted ? fits(entries[i].nominal, *wanted) : when.empty() || i + 1 == index) by_nominal.push_back(i);
  }
  return by_nominal.empty() ? by_release : by_nominal;
}

const Entry &choose(const Source &source, const std::vector<Entry> &entries, const SoundingChoice &choice,
                    std::vector<std::string> &notes) {
  const std::vector<std::size_t> found = fitting(source, entries, choice);
  if (found.empty()) {
    std::string asked = "a sounding";
    if (!choice.station.empty()) asked += " of station " + quoted(choice.station);
    if (!choice.when.empty()) asked += (choice.when.starts_with('#') ? " at index " : " at ") + quoted(choice.when);
    source.fail(1, 1, asked, count_of(entries.size(), "sounding") + ": " + list_of(entries),
                "choose by one of these names and times, or by #number");
  }
  const Entry &entry = entries[found.front()];
  if (found.size() > 1)
    notes.push_back("took sounding #" + std::to_string(found.front() + 1) + " (" + entry_text(entry) +
                    "), the first of " + std::to_string(found.size()) + " that fit the choice");
  return entry;
}

}  // namespace greenray::sounding
