// Which family a file belongs to, and the way from its bytes to a profile.
#include "atmosphere/sounding.hpp"

#include <algorithm>

#include "atmosphere/sounding_parts.hpp"

namespace greenray {

using namespace sounding;

namespace {

enum class Format { unknown, packed, derived, empty, binary, page, list, igra2, wyoming_csv, plain_csv };

std::string_view without_bom(std::string_view text) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  return text;
}

bool is_control(char c) {
  const unsigned char u = static_cast<unsigned char>(c);
  return u == 0x7F || (u < 0x20 && u != '\t' && u != '\n' && u != '\r' && u != '\f');
}

bool is_packed(std::string_view text) {
  return text.starts_with("PK\x03\x04") || text.starts_with("PK\x05\x06") || text.starts_with("\x1F\x8B");
}

Format format_of(const std::string &file_name, std::string_view text, const std::vector<TextLine> &lines) {
  if (is_packed(text)) return Format::packed;
  if (lower_case(file_name).find("-drvd") != std::string::npos) return Format::derived;
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF")) return Format::binary;
  if (std::any_of(text.begin(), text.end(), is_control)) return Format::binary;
  if (std::all_of(lines.begin(), lines.end(), [](const TextLine &line) { return is_blank(line.text); }))
    return Format::empty;
  if (looks_like_page(text)) return Format::page;
  const auto any = [&](auto test) {
    return std::any_of(lines.begin(), lines.end(), [&](const TextLine &line) { return test(line.text); });
  };
  if (any(is_igra2_header)) return Format::igra2;
  if (any(is_wyoming_names_row) || any(is_wyoming_title)) return Format::list;
  const auto first = std::find_if(lines.begin(), lines.end(), [](const TextLine &line) {
    return !is_blank(line.text) && !trimmed(line.text).starts_with('#');
  });
  if (first == lines.end() || first->text.find(',') == std::string_view::npos) return Format::unknown;
  return first->text.find("geopotential height") != std::string_view::npos ? Format::wyoming_csv : Format::plain_csv;
}

/// Has the first row a field that begins like a plain profile's columns?
bool names_profile_columns(const std::vector<TextLine> &lines) {
  for (const TextLine &line : lines) {
    const std::string_view text = trimmed(line.text);
    if (text.empty() || text.starts_with('#')) continue;
    if (text.find('=') != text.npos) return false;
    return text.starts_with("height_") || text.starts_with("temperature_") || text.find(",height_") != text.npos ||
           text.find(",temperature_") != text.npos;
  }
  return false;
}

std::string file_stem(const std::string &file_name) {
  const std::string last = file_name.substr(file_name.find_last_of("/\\") + 1);
  const std::size_t dot = last.find_last_of('.');
  return dot == 0 || dot == std::string::npos ? last : last.substr(0, dot);
}

[[noreturn]] void fail_format(const Source &source, Format format, std::string_view text) {
  const std::string sounding =
      "a sounding (Wyoming list, page or CSV, IGRA version 2, or CSV with height_m and temperature_C)";
  switch (format) {
    case Format::packed:
      source.fail(1, 1, sounding, "a packed archive", "unzip it first");
    case Format::derived:
      source.fail(1, 1, "an IGRA version 2 data file", "a derived file (-drvd)",
                  "it has another layout: use the station's -data file");
    case Format::empty:
      source.fail(1, 1, sounding, "an empty file", "was it fetched completely?");
    case Format::binary: {
      const auto bad = std::find_if(source.lines.begin(), source.lines.end(), [](const TextLine &line) {
        return std::any_of(line.text.begin(), line.text.end(), is_control);
      });
      const bool here = bad != source.lines.end();
      const auto column =
          here ? std::find_if(bad->text.begin(), bad->text.end(), is_control) - bad->text.begin() + 1 : 1;
      source.fail(here ? bad->number : 1, static_cast<int>(column), "plain text", "a control character",
                  "this is binary or damaged: save it as UTF-8 text");
    }
    default:
      break;
  }
  const std::vector<TextLine> lines = split_lines(text);
  const auto first =
      std::find_if(lines.begin(), lines.end(), [](const TextLine &line) { return !is_blank(line.text); });
  const bool level =
      first->text.size() >= 51 && first->text.size() <= 52 && first->text[0] >= '1' && first->text[0] <= '3';
  source.fail(
      first->number, 1, sounding, quoted(first->text),
      level ? "this looks like IGRA levels whose header record (#) is lost" : "columns must be separated by commas");
}

struct Reading {
  Entry entry;
  Family family;
  std::vector<RawLevel> rows;
};

Reading read_format(Source &source, Format format, const SoundingChoice &choice, std::vector<std::string> &notes) {
  Reading reading;
  const auto pick = [&](const std::vector<Entry> &entries) { reading.entry = choose(source, entries, choice, notes); };
  if (format == Format::igra2) {
    pick(index_igra2(source));
    reading.rows = read_igra2(source, reading.entry);
  } else if (format == Format::page || format == Format::list) {
    if (format == Format::page) {
      source.lines = split_page(source);
      const auto table = [](const TextLine &line) { return is_wyoming_names_row(line.text); };
      if (std::none_of(source.lines.begin(), source.lines.end(), table)) fail_page(source);
    }
    pick(index_wyoming_list(source));
    reading.rows = read_wyoming_list(source, reading.entry);
    reading.family.shows_below_ground = true;
  } else if (format == Format::wyoming_csv) {
    pick(index_wyoming_csv(source));
    reading.rows = read_wyoming_csv(source, reading.entry);
    reading.family.shows_below_ground = true;
  } else {
    pick(index_plain_csv(source));
    reading.rows = read_plain_csv(source, reading.entry, notes);
    reading.family = {false, false, false};
  }
  return reading;
}

}  // namespace

bool looks_like_sounding(const std::string &file_name, std::string_view text) {
  text = without_bom(text);
  const std::vector<TextLine> lines = split_lines(text);
  switch (format_of(file_name, text, lines)) {
    case Format::unknown:
    case Format::empty:
    case Format::binary:
      return false;
    case Format::plain_csv:
      return names_profile_columns(lines);
    default:
      return true;
  }
}

ProfileSpec read_sounding(const std::string &file_name, std::string_view text, const SoundingChoice &choice) {
  text = without_bom(text);
  Source source{file_name, split_lines(text)};
  const Format format = format_of(file_name, text, source.lines);
  if (format < Format::page) fail_format(source, format, text);
  ProfileSpec profile;
  const Reading reading = read_format(source, format, choice, profile.notes);
  profile.place = {file_name, reading.entry.line, 1};
  const std::string named = entry_text(reading.entry);
  profile.name = reading.entry.stations.empty() ? file_stem(file_name) + (named.empty() ? "" : " " + named) : named;
  clean_levels(source, reading.family, reading.rows, reading.entry.line, profile);
  return profile;
}

}  // namespace greenray
