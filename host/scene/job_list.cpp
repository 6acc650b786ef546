#include "scene/job_list.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>

#include "support/toml_reader.hpp"

namespace greenray {
namespace {

namespace fs = std::filesystem;

bool is_csv(const std::string &file) { return fs::path(file).extension() == ".csv"; }

struct Cell {
  std::string text;
  int column = 1;
};

std::string trimmed(const std::string &text) {
  const std::size_t begin = text.find_first_not_of(" \t\r"), end = text.find_last_not_of(" \t\r");
  return begin == std::string::npos ? "" : text.substr(begin, end - begin + 1);
}

/// Cells between commas; a cell in double quotes may hold commas, and "" for a quote.
std::vector<Cell> cells_of(const std::string &line, const SourcePlace &place) {
  std::vector<Cell> cells{{"", 1}};
  bool quoted = false, was_quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == '"' && quoted && i + 1 < line.size() && line[i + 1] == '"') cells.back().text += line[++i];
    else if (c == '"' && (quoted || trimmed(cells.back().text).empty())) quoted = !quoted, was_quoted = true;
    else if (c == ',' && !quoted) cells.push_back({"", static_cast<int>(i) + 2});
    else cells.back().text += c;
  }
  if (quoted && was_quoted) throw InputError({place.file, place.line, cells.back().column}, "expected a closing quote");
  for (Cell &cell : cells) cell.text = trimmed(cell.text);
  return cells;
}

std::vector<Job> jobs_of_csv(const std::string &file, std::string_view text, std::vector<Diagnostic> &complaints) {
  std::vector<Job> jobs;
  std::vector<Cell> header;
  std::istringstream lines{std::string(text)};
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    const SourcePlace place{file, ++number, 1};
    if (trimmed(line).empty() || trimmed(line)[0] == '#') continue;
    const std::vector<Cell> cells = cells_of(line, place);
    if (header.empty()) {
      header = cells;
      continue;
    }
    if (cells.size() != header.size()) {
      complaints.push_back({place, "expected " + std::to_string(header.size()) + " cells, as the header has, found " +
                                       std::to_string(cells.size())});
      continue;
    }
    Job job;
    job.place = place;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (header[i].text == "scene") job.scene = cells[i].text;
      else if (header[i].text == "name") job.name = cells[i].text;
      else if (!cells[i].text.empty()) job.overrides.push_back(header[i].text + "=" + cells[i].text);
    }
    jobs.push_back(std::move(job));
  }
  if (!header.empty() && std::none_of(header.begin(), header.end(), [](const Cell &c) { return c.text == "scene"; }))
    complaints.push_back({{file, 1, 1}, "expected a column 'scene' that says what to render"});
  return jobs;
}

/// "job[3].sun.altitude_deg" -> 3 and "sun.altitude_deg"
bool split_path(const std::string &path, std::size_t &row, std::string &key) {
  if (path.rfind("job[", 0) != 0) return false;
  const std::size_t end = path.find("].");
  if (end == std::string::npos) return false;
  row = static_cast<std::size_t>(std::stoul(path.substr(4, end - 4)));
  key = path.substr(end + 2);
  return true;
}

std::vector<Job> jobs_of_toml(const std::string &file, std::string_view text, std::vector<Diagnostic> &complaints) {
  TomlDocument document(file, text);
  std::vector<Job> jobs;
  for (const TomlTable &row : document.root().rows("job")) {
    Job job;
    job.place = row.place();
    row.read("scene", job.scene);
    row.read("name", job.name);
    jobs.push_back(std::move(job));
  }
  std::size_t row = 0;
  std::string key;
  for (const auto &[path, value] : document.values()) {
    const bool of_a_job = split_path(path, row, key);
    if (!of_a_job) complaints.push_back({{file, 1, 1}, "expected only [[job]] rows, found '" + path + "'"});
    else if (key != "scene" && key != "name") jobs.at(row).overrides.push_back(key + "=" + value);
  }
  return jobs;
}

void name_jobs(const std::string &file, std::vector<Job> &jobs, std::vector<Diagnostic> &complaints) {
  std::set<std::string> names;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    Job &job = jobs[i];
    if (job.scene.empty()) complaints.push_back({job.place, "expected a scene: a file, or the name of one that ships"});
    if (job.name.empty()) job.name = numbered_name(fs::path(file).stem().string(), i, jobs.size());
    if (job.name.find('/') != std::string::npos || job.name[0] == '.')
      complaints.push_back(
          {job.place, "'" + job.name + "': expected a name without a slash that does not begin with a dot"});
    if (!names.insert(job.name).second) complaints.push_back({job.place, "the name '" + job.name + "' is there twice"});
  }
}

}  // namespace

bool is_job_list(const std::string &file, std::string_view text) {
  if (is_csv(file)) return true;
  try {
    return TomlDocument(file, text).root().has("job");
  } catch (const InputError &) {
    return false;  // whoever reads it as a scene says what is wrong
  }
}

std::vector<Job> parse_jobs(const std::string &file, std::string_view text) {
  std::vector<Diagnostic> complaints;
  std::vector<Job> jobs = is_csv(file) ? jobs_of_csv(file, text, complaints) : jobs_of_toml(file, text, complaints);
  if (jobs.empty() && complaints.empty()) complaints.push_back({{file, 1, 1}, "expected at least one row: a picture"});
  name_jobs(file, jobs, complaints);
  if (!complaints.empty()) throw InputError(std::move(complaints));
  return jobs;
}

std::string numbered_name(const std::string &name, std::size_t index, std::size_t count) {
  const std::size_t digits = std::max<std::size_t>(4, std::to_string(count).size());
  const std::string number = std::to_string(index + 1);
  return name + "-" + std::string(digits - std::min(digits, number.size()), '0') + number;
}

}  // namespace greenray
