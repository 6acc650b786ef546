// Web pages of an archive, reduced to the pieces of text between tags, each with its place in the file.
#include <algorithm>
#include <array>

#include "atmosphere/sounding_parts.hpp"

namespace greenray::sounding {
namespace {

/// Tags that stand inside a line of text; all others end a piece.
bool is_inline(const std::string &name) {
  static const std::array names = {"a", "b", "i", "u", "em", "font", "span", "strong", "tt"};
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// "<H2 class=..>" -> "h2", "</PRE>" -> "/pre".
std::string tag_name(std::string_view tag) {
  tag = tag.substr(1, tag.find_first_of(" \t>", 1) - 1);
  return lower_case(tag);
}

/// The characters begin..end of a line as a piece; nothing if there are none.
void add_piece(std::vector<TextLine> &pieces, const TextLine &line, std::size_t begin, std::size_t end, int block) {
  if (begin < end)
    pieces.push_back({line.number, static_cast<int>(begin) + 1, line.text.substr(begin, end - begin), block});
}

}  // namespace

bool looks_like_page(std::string_view text) {
  static constexpr std::array<std::string_view, 8> marks = {"<html", "<!doctype", "<head",  "<title",
                                                            "<body", "<pre>",     "</pre>", "</html>"};
  const std::string start = lower_case(text.substr(0, 65536));
  return std::any_of(marks.begin(), marks.end(), [&](std::string_view mark) { return start.find(mark) != start.npos; });
}

std::vector<TextLine> split_page(const Source &source) {
  std::vector<TextLine> pieces;
  int block = 0, pre_line = 1;
  bool in_tag = false;  // a tag may go on over several lines
  int tag_line = 1, tag_column = 1;
  for (const TextLine &line : source.lines) {
    const std::string_view text = line.text;
    std::size_t begin = 0, at = 0;
    while (at < text.size()) {
      if (in_tag) {
        const std::size_t close = text.find('>', at);
        in_tag = close == text.npos;
        at = begin = in_tag ? text.size() : close + 1;
        continue;
      }
      const std::size_t open = text.find('<', at);
      if (open == text.npos) break;
      const std::string name = tag_name(text.substr(open));
      if (!is_inline(name.starts_with('/') ? name.substr(1) : name) || block % 2) {
        add_piece(pieces, line, begin, open, block);
        begin = open;
      }
      if (name == "pre" && block % 2 == 0) ++block, pre_line = line.number;
      if (name == "/pre" && block % 2 == 1) ++block;
      const std::size_t close = text.find('>', open);
      in_tag = close == text.npos;
      tag_line = line.number, tag_column = static_cast<int>(open) + 1;
      at = in_tag ? text.size() : close + 1;
      if (begin == open || in_tag) begin = at;
    }
    add_piece(pieces, line, begin, text.size(), block);
  }
  if (in_tag)
    source.fail(tag_line, tag_column, "the end > of this tag", "the end of the page", "the page is truncated");
  if (block % 2)
    source.fail(source.lines.back().number, 1, "</PRE> for the <PRE> in line " + std::to_string(pre_line),
                "the end of the page", "the page is truncated: fetch it again");
  return pieces;
}

void fail_page(const Source &page) {
  static constexpr std::array<std::string_view, 6> sorry = {"can't", "cannot", "sorry", "unable", "error", "no data"};
  const TextLine *said = nullptr;
  for (const TextLine &piece : page.lines) {
    if (is_blank(piece.text)) continue;
    const std::string lower = lower_case(piece.text);
    const bool complaint =
        std::any_of(sorry.begin(), sorry.end(), [&](std::string_view word) { return lower.find(word) != lower.npos; });
    if (!said) said = &piece;
    if (complaint) {
      said = &piece;
      break;
    }
  }
  page.fail(said ? said->number : 1, said ? said->column : 1, "a page with a sounding in <PRE>",
            said ? quoted(said->text) : "an empty page",
            "the archive sent no sounding: check station and time, or ask again later");
}

}  // namespace greenray::sounding
