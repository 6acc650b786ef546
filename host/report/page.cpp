#include "report/page.hpp"

#include <cmath>

#include "atmosphere/diagnosis.hpp"

namespace greenray {
namespace {

const char *const style_sheet = R"css(
body { margin: 0; background: #f6f6f3; color: #1e2326; font: 15px/1.5 "DejaVu Sans", Helvetica, Arial, sans-serif; }
main { max-width: 1020px; margin: 0 auto; padding: 24px 20px 60px; }
h1 { font-size: 25px; margin: 0; } h2 { font-size: 18px; margin: 34px 0 8px; border-bottom: 1px solid #d8d8d2; }
p { margin: 6px 0 10px; } .soft, figcaption { color: #5d6870; font-size: 13px; }
.row { display: flex; flex-wrap: wrap; gap: 14px; align-items: flex-start; }
figure { margin: 0 0 12px; background: #fff; border: 1px solid #dcdcd6; padding: 8px; display: inline-block; vertical-align: top; }
figure img { display: block; max-width: 100%; } figure svg { display: block; max-width: 100%; height: auto; }
.sharp { image-rendering: pixelated; }
.warning { background: #fff4d6; border: 1px solid #e4c468; padding: 8px 14px; }
table { border-collapse: collapse; background: #fff; font-size: 13px; margin: 6px 0 14px; }
th, td { border: 1px solid #dcdcd6; padding: 3px 9px; text-align: left; } th { background: #eeeeea; } td.n { text-align: right; font-variant-numeric: tabular-nums; }
code { display: block; background: #23282b; color: #f0f0ea; padding: 10px 14px; overflow-wrap: anywhere; }
)css";

std::string escaped(const std::string &text) {
  std::string safe;
  for (const char c : text) {
    if (c == '&') safe += "&amp;";
    else if (c == '<') safe += "&lt;";
    else if (c == '>') safe += "&gt;";
    else if (c == '"') safe += "&quot;";
    else if (static_cast<unsigned char>(c) < 0x20) safe += ' ';
    else safe += c;
  }
  return safe;
}

std::string base64(const std::vector<char> &bytes) {
  constexpr const char *letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve(bytes.size() * 4 / 3 + 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8U | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k)
      text += i + k <= bytes.size() ? letters[group >> (18U - 6U * static_cast<unsigned>(k)) & 63U] : '=';
  }
  return text;
}

bool is_number(const std::string &text) {
  return !text.empty() && text.find_first_not_of("0123456789.-+eE×%\"") == std::string::npos;
}

}  // namespace

Page::Page(const std::string &title, const std::string &subtitle) : title_(title) {
  body_ = "<h1>" + escaped(title) + "</h1>\n<p class=\"soft\">" + escaped(subtitle) + "</p>\n";
}
void Page::section(const std::string &title) { body_ += "<h2>" + escaped(title) + "</h2>\n"; }
void Page::text(const std::string &words) { body_ += "<p>" + escaped(words) + "</p>\n"; }
void Page::warning(const std::string &words) { body_ += "<p class=\"warning\">" + escaped(words) + "</p>\n"; }
void Page::code(const std::string &line) { body_ += "<code>" + escaped(line) + "</code>\n"; }

void Page::picture(const Raster &pixels, const std::string &caption, int width_px, bool pixelated) {
  body_ += "<figure><img" + std::string(pixelated ? " class=\"sharp\"" : "") + " width=\"" + std::to_string(width_px) +
           "\" alt=\"" + escaped(caption) + "\" src=\"data:image/png;base64," + base64(encode_png(pixels)) +
           "\"/>\n<figcaption>" + escaped(caption) + "</figcaption></figure>\n";
}

void Page::figure(const std::vector<Plot> &plots) {
  std::vector<Plot> own = plots;
  for (Plot &plot : own) plot.id = "figure" + std::to_string(++figures_);
  std::string svg = draw_svg(own);
  svg.erase(0, svg.find("<svg"));
  body_ += "<figure>" + svg + "</figure>\n";
}

void Page::facts(const std::vector<std::pair<std::string, std::string>> &rows) {
  body_ += "<table>\n";
  for (const auto &[name, value] : rows)
    body_ += "<tr><th>" + escaped(name) + "</th><td>" + escaped(value) + "</td></tr>\n";
  body_ += "</table>\n";
}

void Page::table(const std::vector<std::vector<std::string>> &rows) {
  body_ += "<table>\n";
  for (std::size_t i = 0; i < rows.size(); ++i) {
    body_ += "<tr>";
    for (const std::string &word : rows[i])
      body_ += i == 0 ? "<th>" + escaped(word) + "</th>"
                      : (is_number(word) ? "<td class=\"n\">" : "<td>") + escaped(word) + "</td>";
    body_ += "</tr>\n";
  }
  body_ += "</table>\n";
}

std::string Page::finish() const {
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n<title>" + escaped(title_) +
         "</title>\n<style>" + style_sheet + "</style>\n</head>\n<body>\n<main>\n" + body_ +
         "</main>\n</body>\n</html>\n";
}

std::string cell(double value, int digits) { return std::isfinite(value) ? plain_number(value, digits) : "-"; }

}  // namespace greenray
