// The transfer curve as a CSV file that others can use, and back.
#include <charconv>
#include <fstream>
#include <sstream>

#include "render/transfer_curve.hpp"
#include "support/angle.hpp"
#include "support/error.hpp"

namespace greenray {
namespace {

const std::string header =
    "apparent_altitude_deg,wavelength_nm,status,refraction_arcsec,true_altitude_deg,air_mass,min_height_m,"
    "ground_distance_m,joined_to_next";

std::string exact(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

/// One line of the file, taken apart with the place of each cell for complaints.
class Line {
 public:
  Line(const std::string &file, int number, const std::string &text) : file_(file), number_(number) {
    std::size_t start = 0;
    for (std::size_t end; start <= text.size(); start = end + 1) {
      end = std::min(text.find(',', start), text.size());
      cells_.push_back({text.substr(start, end - start), static_cast<int>(start) + 1});
    }
  }
  std::size_t count() const { return cells_.size(); }
  const std::string &text(std::size_t i) const { return cells_[i].first; }
  bool empty(std::size_t i) const { return text(i).empty(); }
  double number(std::size_t i) const {
    double value = 0;
    const char *end = text(i).data() + text(i).size();
    const auto read = std::from_chars(text(i).data(), end, value);
    if (read.ec != std::errc() || read.ptr != end || !std::isfinite(value)) fail(i, "expected a number");
    return value;
  }
  [[noreturn]] void fail(std::size_t i, const std::string &what) const {
    throw InputError({file_, number_, i < cells_.size() ? cells_[i].second : 1}, what);
  }

 private:
  std::string file_;
  int number_;
  std::vector<std::pair<std::string, int>> cells_;
};

int outcome_of(const Line &line, std::size_t i) {
  for (int outcome : {f64::RAY_SPACE, f64::RAY_GROUND, f64::RAY_TRAPPED, f64::RAY_LIMIT})
    if (line.text(i) == outcome_name(outcome)) return outcome;
  line.fail(i, "'" + line.text(i) + "': expected space | ground | trapped | limit");
}

Transfer transfer_from(const Line &line, double elevation_rad, double zenith_column_kg_m2) {
  Transfer t{};
  t.outcome = outcome_of(line, 2);
  if (!line.empty(3)) t.bending_rad = from_arcsec(line.number(3));
  t.true_altitude_rad = elevation_rad - t.bending_rad;
  if (!line.empty(5)) t.column[0] = line.number(5) * zenith_column_kg_m2;
  t.min_height_m = line.number(6);
  if (!line.empty(7)) t.distance_m = line.number(7);
  return t;
}

/// "# key value" before the header.
void read_remark(const Line &line, const std::string &text, TransferCurve &curve) {
  std::istringstream words(text);
  std::string hash, key;
  words >> hash >> key;
  if (key == "profile") words >> curve.profile;
  if (key != "height_m" && key != "zenith_column_kg_m2") return;
  double value;
  if (!(words >> value)) line.fail(0, "expected a number after '# " + key + "'");
  (key == "height_m" ? curve.height_m : curve.zenith_column_kg_m2) = value;
}

/// Takes one row; rows go by elevation, then wavelength.
void read_row(const Line &line, TransferCurve &curve) {
  if (line.count() != 9) line.fail(0, "expected 9 cells, as in the header; found " + std::to_string(line.count()));
  const double elevation = to_rad(line.number(0)), wavelength = line.number(1);
  const bool first_elevation = curve.elevation_rad.size() <= 1;
  if (curve.elevation_rad.empty() || elevation != curve.elevation_rad.back()) {
    if (!curve.elevation_rad.empty() && elevation < curve.elevation_rad.back())
      line.fail(0, "expected apparent altitudes in ascending order");
    if (curve.rays.size() != curve.elevation_rad.size() * curve.wavelength_nm.size())
      line.fail(0, "expected the same wavelengths at every altitude");
    curve.elevation_rad.push_back(elevation);
  } else if (!first_elevation && curve.rays.size() >= curve.elevation_rad.size() * curve.wavelength_nm.size()) {
    line.fail(1, "expected the same wavelengths at every altitude");
  }
  if (curve.elevation_rad.size() == 1) curve.wavelength_nm.push_back(wavelength);
  else if (wavelength != curve.wavelength_nm[curve.rays.size() % curve.wavelength_nm.size()])
    line.fail(1, "expected the same wavelengths at every altitude");
  curve.rays.push_back(transfer_from(line, elevation, curve.zenith_column_kg_m2));
  const double joined = line.number(8);
  if (joined != 0 && joined != 1) line.fail(8, "expected 0 or 1");
  curve.joined_to_next.push_back(joined == 1);
}

}  // namespace

std::string as_csv(const TransferCurve &curve) {
  std::ostringstream out;
  out << "# greenray transfer curve 1\n# profile " << curve.profile << "\n# height_m " << exact(curve.height_m)
      << "\n# zenith_column_kg_m2 " << exact(curve.zenith_column_kg_m2) << "\n# interpolation error "
      << curve.interpolation_arcsec << " arcsec, over max(1, |d true/d apparent|)\n"
      << "# between rows of one wavelength: linear, unless joined_to_next is 0, where the ray's fate jumps\n"
      << header << "\n";
  for (std::size_t e = 0; e < curve.elevation_rad.size(); ++e)
    for (std::size_t w = 0; w < curve.wavelength_nm.size(); ++w) {
      const Transfer &t = curve.at(e, w);
      const bool space = t.outcome == f64::RAY_SPACE, ended = space || t.outcome == f64::RAY_GROUND;
      out << exact(to_deg(curve.elevation_rad[e])) << ',' << exact(curve.wavelength_nm[w]) << ','
          << outcome_name(t.outcome) << ',' << (ended ? exact(to_arcsec(t.bending_rad)) : "") << ','
          << (space ? exact(to_deg(t.true_altitude_rad)) : "") << ','
          << (ended && curve.zenith_column_kg_m2 > 0 ? exact(t.column[0] / curve.zenith_column_kg_m2) : "") << ','
          << exact(t.min_height_m) << ',' << (ended ? exact(t.distance_m) : "") << ',' << curve.joined(e, w) << '\n';
    }
  return out.str();
}

TransferCurve read_transfer_curve(const std::filesystem::path &path) {
  std::ifstream file(path);
  const std::string wanted = "expected a table made by `greenray transfer -o`";
  if (!file) throw InputError({path.string(), 1, 1}, "cannot be read: " + wanted);
  TransferCurve curve;
  int number = 0;
  bool in_rows = false;
  for (std::string text; std::getline(file, text);) {
    if (!text.empty() && text.back() == '\r') text.pop_back();
    const Line line(path.string(), ++number, text);
    if (number == 1 && text.rfind("# greenray transfer curve 1", 0) != 0) line.fail(0, wanted);
    if (text.empty()) continue;
    if (in_rows) read_row(line, curve);
    else if (text[0] == '#') read_remark(line, text, curve);
    else if (text == header) in_rows = true;
    else line.fail(0, "expected the header '" + header + "'");
  }
  if (curve.elevation_rad.size() < 2 || curve.rays.size() != curve.elevation_rad.size() * curve.wavelength_nm.size())
    throw InputError({path.string(), number, 1},
                     "the table ends too early: expected two altitudes or more, each with "
                     "every wavelength");
  return curve;
}

}  // namespace greenray
