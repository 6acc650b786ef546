#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>

#include "bench/ratios.hpp"
#include "bench/report.hpp"

namespace greenray::bench {
namespace {

const char *const style_sheet = R"css(
:root { --ink: #1d2429; --soft: #5d6870; --rule: #dfe3e2; --paper: #fff; --wash: #f5f7f6; --good: #1c7a4d; --fair: #9a6a00; --bad: #b3341f; }
* { box-sizing: border-box; }
body { margin: 0; background: var(--wash); color: var(--ink); font: 15px/1.55 system-ui, "DejaVu Sans", "Segoe UI", Helvetica, Arial, sans-serif; }
main { max-width: 1180px; margin: 0 auto; padding: 28px 24px 60px; }
h1 { font-size: 27px; line-height: 1.2; margin: 0 0 4px; letter-spacing: -.01em; }
h2 { font-size: 19px; margin: 40px 0 10px; }
p { margin: 6px 0 12px; max-width: 76ch; }
.soft { color: var(--soft); }
.card, figure, .table { background: var(--paper); border: 1px solid var(--rule); border-radius: 8px; }
.cards { display: grid; grid-template-columns: repeat(auto-fit, minmax(188px, 1fr)); gap: 12px; margin: 20px 0; }
.card { padding: 12px 16px; }
.card b { display: block; font-size: 24px; white-space: nowrap; line-height: 1.25; font-variant-numeric: tabular-nums; }
.card span { color: var(--soft); font-size: 13px; }
.warning { background: #fff4d6; border: 1px solid #e4c468; border-radius: 8px; padding: 10px 16px; margin: 16px 0; }
figure { margin: 0 0 18px; padding: 8px 10px 12px; }
figure > svg { display: block; width: 100%; height: auto; }
figcaption { color: var(--soft); font-size: 13px; padding: 0 12px; }
.legend { display: grid; grid-template-columns: repeat(auto-fill, minmax(290px, 1fr)); gap: 2px 18px; padding: 4px 12px; margin: 0; list-style: none; font-size: 13px; }
.legend svg { vertical-align: -1px; margin-right: 8px; }
.table { overflow-x: auto; }
table { border-collapse: collapse; width: 100%; font-size: 13.5px; }
th { text-align: left; font-weight: 600; color: var(--soft); background: var(--wash); white-space: nowrap; }
th, td { padding: 6px 10px; border-bottom: 1px solid var(--rule); vertical-align: top; }
tr:last-child td { border-bottom: 0; }
td.n, th.n { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
td .soft { font-size: 12px; display: block; }
td.what { min-width: 290px; }
.side { display: block; font-size: 12px; line-height: 1.45; color: var(--soft); }
.side i { font-style: normal; display: inline-block; width: 46px; color: #98a19f; }
.group td { background: var(--wash); font-weight: 600; }
.verdict { border-radius: 99px; padding: 1px 9px; font-size: 12px; color: #fff; white-space: nowrap; }
.aim { background: var(--good); } .floor { background: var(--fair); } .missed { background: var(--bad); }
summary { cursor: pointer; font-weight: 600; margin: 28px 0 10px; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: 2px 18px; margin: 8px 0; font-size: 13.5px; }
dt { color: var(--soft); } dd { margin: 0; }
@media print { body { background: #fff; } figure, .table { break-inside: avoid; } }
)css";

std::string escaped(const std::string &text) {
  std::string safe;
  for (const char c : text) {
    if (c == '&') safe += "&amp;";
    else if (c == '<') safe += "&lt;";
    else if (c == '>') safe += "&gt;";
    else if (c == '"') safe += "&quot;";
    else safe += c;
  }
  return safe;
}

std::string about(const Results &results, const std::string &what) {
  const auto at = results.about.find(what);
  return at == results.about.end() ? "" : at->second;
}

std::string times(double ratio) {
  char text[32];
  std::snprintf(text, sizeof text, ratio >= 100 ? "%.0f×" : ratio >= 10 ? "%.1f×" : "%.2f×", ratio);
  return text;
}

std::string error_words(double error, const std::string &unit) {
  return unit == "arcsec" ? short_number(error) + "″" : short_number(error);
}

// ---- the ratios

/// 0.1 to 10 000 on 150 pixels: the ratio as a dot, floor and aim as ticks.
std::string track(const Ratio &r) {
  constexpr double left = 6, width = 138, decades = 5;
  const auto place = [&](double v) { return left + width * std::clamp((std::log10(v) + 1) / decades, 0.0, 1.0); };
  std::ostringstream svg;
  svg << "<svg width=\"150\" height=\"18\" viewBox=\"0 0 150 18\" aria-hidden=\"true\"><path d=\"M" << left << " 9h"
      << width << "\" stroke=\"#dfe3e2\" stroke-width=\"2\"/>";
  const auto tick = [&](double v, const char *colour) {
    if (v > 0) svg << "<path d=\"M" << place(v) << " 3v12\" stroke=\"" << colour << "\" stroke-width=\"2\"/>";
  };
  tick(1, "#c9cfcd"), tick(r.floor, "#d9a336"), tick(r.aim, "#1c7a4d");
  svg << "<circle cx=\"" << place(r.value) << "\" cy=\"9\" r=\"4.5\" fill=\"#1d2429\"/></svg>";
  return svg.str();
}

std::string verdict_cell(const Ratio &r) {
  const std::string verdict = r.verdict();
  if (verdict.empty()) return "";
  const char *words = verdict == "aim" ? "aim met" : verdict == "missed" ? "missed" : r.aim > 0 ? "floor met" : "met";
  return "<span class=\"verdict " + std::string(r.aim > 0 || verdict == "missed" ? verdict : "aim") + "\">" + words +
         "</span>";
}

std::string asked(const Ratio &r) {
  if (r.basis == Basis::cost) return r.floor > 0 ? "≤ " + short_number(r.floor) + "×" : "";
  std::string words = r.floor > 0 ? short_number(r.floor) + "×" : "";
  if (r.aim > 0) words += " / " + short_number(r.aim) + "×";
  return words;
}

std::string side(const char *who, const std::string &variant, double error, const std::string &unit) {
  if (variant.empty()) return "";
  return "<span class=\"side\"><i>" + std::string(who) + "</i> " + escaped(variant) + "; error " +
         error_words(error, unit) + "</span>";
}

std::string ratio_table(const std::vector<Ratio> &ratios) {
  std::string html =
      "<div class=\"table\"><table><thead><tr><th>what</th><th class=\"n\">ratio</th><th></th>"
      "<th class=\"n\">floor / aim</th><th></th><th>settings</th></tr></thead><tbody>\n";
  std::string last;
  for (const Ratio &r : ratios) {
    if (r.case_name != last) html += "<tr class=\"group\"><td colspan=\"6\">" + escaped(r.case_name) + "</td></tr>\n";
    last = r.case_name;
    html += "<tr><td class=\"what\">" + escaped(r.what) + "<span class=\"soft\">" +
            (r.note.empty() ? basis_words(r.basis) : escaped(r.note)) + "</span></td><td class=\"n\"><b>" +
            (r.measured() ? times(r.value) : "–") + "</b></td><td>" + (r.measured() ? track(r) : "") +
            "</td><td class=\"n\">" + asked(r) + "</td><td>" + verdict_cell(r) + "</td><td>" +
            side("ours", r.ours, r.our_error, r.error_unit) + side("against", r.theirs, r.their_error, r.error_unit) +
            "</td></tr>\n";
  }
  return html + "</tbody></table></div>\n";
}

// ---- the other parts

std::string card(const std::string &value, const std::string &words) {
  return "<div class=\"card\"><b>" + value + "</b><span>" + words + "</span></div>\n";
}

std::string cards(const Results &results, const std::vector<Ratio> &ratios) {
  std::string html;
  const auto ratio_card = [&](const std::string &what, const std::string &case_name, const std::string &words) {
    for (const Ratio &r : ratios)
      if (r.measured() && r.what.rfind(what, 0) == 0 && r.case_name == case_name) {
        html += card(times(r.value), words);
        return;
      }
  };
  const Record *fastest = nullptr, *picture = nullptr;
  for (const Record &r : results.records) {
    if (r.suite == "trace" && r.case_name == "us76" && r.ours() && r.error <= 0.01 &&
        (!fastest || r.rate > fastest->rate))
      fastest = &r;
    if (r.suite == "images" && r.kind.solver == "transfer table" && r.number("samples_per_pixel") == 1 &&
        (!picture || r.number("pixels") > picture->number("pixels")))
      picture = &r;
  }
  if (fastest)
    html += card(short_number(fastest->rate) + "ray/s",
                 "through standard air, error " + error_words(fastest->error, "arcsec"));
  ratio_card("closed form / odeint dopri5 tuned at 0.01", "us76", "a tuned odeint dopri5 of no smaller error");
  ratio_card("closed form / odeint dopri5 untuned at 0.01", "us76", "odeint dopri5 as it comes");
  ratio_card("closed form / palRefro", "pal-air", "palRefro at 1e-6, in its own air");
  if (picture)
    html += card(short_number(picture->wall_seconds) + " s", "a picture of " + escaped(picture->case_name.substr(4)) +
                                                                 " in " + short_number(picture->number("wavelengths")) +
                                                                 " wavelengths");
  return html.empty() ? "" : "<div class=\"cards\">\n" + html + "</div>\n";
}

std::string figure(const Figure &f) {
  std::string svg = draw_svg(f.plot);
  svg.erase(0, svg.find("<svg"));
  std::string html = "<figure>\n" + svg + "<ul class=\"legend\">\n";
  for (const PlotLine &line : f.legend) html += "<li>" + svg_swatch(line) + escaped(line.name) + "</li>\n";
  html += "</ul>\n";
  if (!f.caption.empty()) html += "<figcaption>" + escaped(f.caption) + "</figcaption>\n";
  return html + "</figure>\n";
}

std::string section(const std::string &title, const std::string &words, const std::vector<Figure> &figures) {
  if (figures.empty()) return "";
  std::string html = "<h2>" + title + "</h2>\n" + words;
  for (const Figure &f : figures) html += figure(f);
  return html;
}

std::string machine(const Results &results) {
  std::string html = "<h2>Machine</h2>\n<dl>\n";
  for (const auto &[name, value] : results.about) {
    std::string words = name;
    std::replace(words.begin(), words.end(), '_', ' ');
    html += "<dt>" + escaped(words) + "</dt><dd>" + escaped(value) + "</dd>\n";
  }
  return html + "</dl>\n";
}

std::string record_table(const Results &results) {
  std::string html =
      "<details><summary>All records</summary>\n<div class=\"table\"><table><thead><tr><th>case</th><th>variant</th>"
      "<th class=\"n\">rate</th><th class=\"n\">error</th><th class=\"n\">CPU s</th><th class=\"n\">wall s</th>"
      "<th class=\"n\">spread</th><th class=\"n\">ratio</th></tr></thead><tbody>\n";
  std::string last;
  for (const Record &r : results.records) {
    const std::string group = r.suite + ": " + r.case_name;
    if (group != last) html += "<tr class=\"group\"><td colspan=\"8\">" + escaped(group) + "</td></tr>\n";
    last = group;
    char spread[32];
    std::snprintf(spread, sizeof spread, "%.1f %%", 100 * r.spread());
    html += "<tr><td>" + escaped(r.case_name) + "</td><td>" + escaped(r.variant) + "</td><td class=\"n\">" +
            short_number(r.rate) + " " + escaped(r.rate_unit) + "</td><td class=\"n\">" +
            error_words(r.error, r.error_unit) + "</td><td class=\"n\">" + short_number(r.cpu_seconds) +
            "</td><td class=\"n\">" + short_number(r.wall_seconds) + "</td><td class=\"n\">" + spread +
            "</td><td class=\"n\">" + (r.peer ? times(r.peer->ratio) : "") + "</td></tr>\n";
  }
  return html + "</tbody></table></div></details>\n";
}

const char *const how_ratios_are_made =
    "<p>At a level of error the peer shows its fastest setting with no larger error, and we show our fastest setting "
    "whose "
    "error is no larger than that setting’s. Speeds are rays per second of CPU time unless the row says otherwise: all "
    "methods take turns in one process, on the same threads, and the best of the rounds counts. Ticks: equal speed, "
    "<span style=\"color:#9a6a00\">floor</span>, <span style=\"color:#1c7a4d\">aim</span>; the scale runs from 0.1 to "
    "10 000.</p>\n";

const char *const how_curves_are_read =
    "<p>Every point is one setting: its rays per second, all threads, against its largest error over the reference "
    "rays. "
    "The settings that no other of the same curve beats in both are joined. Colour tells the solver; discs are our "
    "kernels on the device (hollow: one lane; dashed: double), diamonds the same text as native C++, squares "
    "Boost.odeint, "
    "triangles palRefro. Rest the pointer on a point for its setting.</p>\n";

}  // namespace

std::string as_html(const Results &results) {
  const std::vector<Ratio> ratios = ratios_of(results);
  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n"
      "<title>greenray bench: speed against error</title>\n<style>" +
      std::string(style_sheet) +
      "</style>\n</head>\n<body>\n<main>\n<h1>Speed against error</h1>\n<p class=\"soft\">greenray " +
      escaped(about(results, "version")) + " on " + escaped(about(results, "cpu")) + ", " +
      escaped(about(results, "threads")) + " threads, " + escaped(about(results, "device")) +
      (about(results, "date").empty() ? "" : ", " + escaped(about(results, "date"))) + "</p>\n";
  if (results.contended)
    html += "<p class=\"warning\"><b>Contended: do not publish.</b> Load " + escaped(about(results, "load_before")) +
            " before and " + escaped(about(results, "load_after")) + " after; others kept " +
            escaped(about(results, "cores_busy_with_others")) + " cores busy.</p>\n";
  html += cards(results, ratios);
  if (!ratios.empty()) html += "<h2>Ratios of this run</h2>\n" + std::string(how_ratios_are_made) + ratio_table(ratios);
  html += section("Rays: error against speed", how_curves_are_read, work_precision_figures(results));
  html += section("Growth", "", growth_figures(results));
  html += section("Whole pictures", "", image_figures(results));
  html += section("Rooms", "What a given error costs: read the seconds off the curve.", room_figures(results));
  html += machine(results) + record_table(results);
  return html + "<p class=\"soft\">" + escaped(results.summary) + "</p>\n</main>\n</body>\n</html>\n";
}

}  // namespace greenray::bench
