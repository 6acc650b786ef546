// greenray eye: the state of an eye that looks at a light.
#include <fstream>
#include <iomanip>
#include <iostream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/commands.hpp"
#include "cli/eye_flags.hpp"
#include "support/csv_table.hpp"
#include "vision/bleaching.hpp"
#include "vision/cones.hpp"
#include "vision/report_json.hpp"

namespace greenray::cli {
namespace {

using Json = nlohmann::json;
using vision::Lms;

/// Two columns, wavelength in nm and radiance (any names, any further columns).
vision::Spectrum read_spectrum(const Arguments &a, const std::string &flag) {
  const std::string name = a.text(flag);
  std::ifstream file(name);
  if (!file) a.fail(flag, "expected a CSV file of wavelength in nm and radiance, found no readable file");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const CsvTable table = CsvTable::parse(text, name);
  if (table.names().size() < 2) throw InputError({name, 1, 1}, "expected two columns: wavelength in nm, and radiance");
  vision::Spectrum light{table.column(table.names()[0]), table.column(table.names()[1])};
  try {
    vision::check_spectrum(light);
  } catch (const std::domain_error &error) {
    throw InputError({name, 1, 1}, error.what());
  }
  return light;
}

struct Moment {
  double seconds;
  Lms unbleached;
};

struct EyeState {
  double luminance_cd_m2, pupil_mm, effectivity, td;
  vision::PupilField field;
  Lms cone_td, steady;
  std::vector<Moment> moments;
};

Lms after(const Lms &td, double seconds, const vision::Pigment &pigment) {
  Lms u{};
  for (std::size_t i = 0; i < 3; ++i) u[i] = vision::unbleached_after(1, td[i], seconds, pigment);
  return u;
}

std::optional<double> looks_like_nm(const Lms &catches, const Lms &u) {
  return vision::equivalent_wavelength_nm({catches[0] * u[0], catches[1] * u[1], catches[2] * u[2]});
}

Json optional(const std::optional<double> &value) { return value ? Json(*value) : Json(); }
Json lms_json(const Lms &v) { return {{"L", v[0]}, {"M", v[1]}, {"S", v[2]}}; }

void print(const EyeState &eye, const std::string &pupil, const Lms &seen, bool has_test) {
  std::cout << std::setprecision(6) << "light      " << eye.luminance_cd_m2 << " cd/m2 over " << eye.field.area_deg2
            << " deg2\npupil      " << eye.pupil_mm << " mm (" << pupil << "), effectivity " << eye.effectivity
            << "\nretina     " << eye.td << " td;  cones L " << eye.cone_td[0] << "  M " << eye.cone_td[1] << "  S "
            << eye.cone_td[2] << " td\n"
            << "seconds    unbleached L  M  S" << std::string(11, ' ') << "M/L gain  "
            << (has_test ? "test light" : "light") << " looks like [nm]\n";
  const auto row = [&](const std::string &when, const Lms &u) {
    std::cout << std::left << std::setw(11) << when << std::fixed << std::setprecision(5) << u[0] << "  " << u[1]
              << "  " << u[2] << "  " << std::setw(10) << std::setprecision(4) << u[1] / u[0];
    const auto nm = looks_like_nm(seen, u);
    if (nm) std::cout << std::setprecision(1) << *nm;
    else std::cout << "no single wavelength";
    std::cout << std::defaultfloat << "\n";
  };
  row("0", {1, 1, 1});
  for (const Moment &m : eye.moments) row(digits(m.seconds), m.unbleached);
  row("steady", eye.steady);
}

void print_json(const EyeState &eye, const std::string &pupil, const Lms &seen) {
  Json moments = Json::array();
  for (const Moment &m : eye.moments)
    moments.push_back({{"seconds", m.seconds},
                       {"L", m.unbleached[0]},
                       {"M", m.unbleached[1]},
                       {"S", m.unbleached[2]},
                       {"equivalent_nm", optional(looks_like_nm(seen, m.unbleached))}});
  const Json steady{{"L", eye.steady[0]},
                    {"M", eye.steady[1]},
                    {"S", eye.steady[2]},
                    {"equivalent_nm", optional(looks_like_nm(seen, eye.steady))}};
  std::cout << Json{{"luminance_cd_m2", eye.luminance_cd_m2},
                    {"field_deg2", eye.field.area_deg2},
                    {"pupil_model", pupil},
                    {"pupil_mm", eye.pupil_mm},
                    {"effectivity", eye.effectivity},
                    {"trolands", eye.td},
                    {"cone_trolands", lms_json(eye.cone_td)},
                    {"equivalent_nm", optional(looks_like_nm(seen, {1, 1, 1}))},
                    {"unbleached", moments},
                    {"steady", steady}}
                   .dump(1)
            << "\n";
}

int eye(const Arguments &a) {
  const vision::Spectrum light =
      a.has("--spectrum") ? read_spectrum(a, "--spectrum") : vision::Spectrum{{390, 780}, {1, 1}};
  if (!a.has("--luminance") && !a.has("--spectrum"))
    throw InputError({"command line", 1, 14},
                     "missing --luminance CDM2: of the light (or --spectrum FILE.csv in W m^-2 sr^-1 nm^-1)");
  EyeState state{};
  state.luminance_cd_m2 =
      a.has("--luminance") ? a.number("--luminance", 0, 1e12, "cd/m2") : vision::luminance_cd_m2(light);
  state.field = {state.luminance_cd_m2, a.optional_number("--field-deg2", 1e-9, 41253, "deg2").value_or(60),
                 a.optional_number("--age", 20, 83, "years").value_or(28.58),
                 a.choice("--eyes", {"1", "2"}, "2") == "1" ? 1 : 2};
  const vision::PupilModel model = pupil_model(a);
  state.pupil_mm = vision::pupil_diameter_mm(model, state.field);
  state.effectivity = vision::effectivity(state.pupil_mm);
  state.td = vision::trolands(state.luminance_cd_m2, state.pupil_mm);
  state.cone_td = vision::cone_trolands(light, state.td);
  const vision::Pigment pigment{
      a.optional_number("--half-bleach", 1, 1e9, "td").value_or(vision::rushton_henry.half_bleach_td),
      a.optional_number("--time-constant", 1e-3, 1e6, "s").value_or(vision::rushton_henry.time_constant_s)};
  const std::vector<double> seconds =
      a.has("--seconds") ? a.list("--seconds", 0, 1e9, "s") : std::vector<double>{1, 3, 10, 60};
  for (const double t : seconds) state.moments.push_back({t, after(state.cone_td, t, pigment)});
  for (std::size_t i = 0; i < 3; ++i) state.steady[i] = vision::steady_unbleached(state.cone_td[i], pigment);
  const Lms seen = vision::cone_catches(a.has("--test") ? read_spectrum(a, "--test") : light);
  if (a.has("--json")) print_json(state, vision::name_of(model), seen);
  else print(state, vision::name_of(model), seen, a.has("--test"));
  return 0;
}

}  // namespace

Command eye_command() {
  std::vector<Flag> flags{{"--luminance", "", "CDM2", "of the light, 0 to 1e12 (the spectrum's own, if one is given)"},
                          {"--field-deg2", "", "A", "square degrees that it fills (60); the Sun: 0.22"},
                          {"--spectrum", "", "FILE.csv", "of the light: wavelength in nm, radiance (equal energy)"},
                          {"--seconds", "", "LIST", "of looking, from an eye at rest (1,3,10,60)"},
                          {"--test", "", "FILE.csv", "another light, seen by the bleached eye: what does it look like"},
                          {"--half-bleach", "", "TD", "steady light that bleaches half (20000, Rushton & Henry 1968)"},
                          {"--time-constant", "", "S", "of regeneration (120)"}};
  for (Flag &flag : pupil_flags()) flags.push_back(std::move(flag));
  return {with_common(
              {"eye", "", "The state of an eye that looks at a light: pupil, trolands, bleaching over time.", flags}),
          eye};
}

}  // namespace greenray::cli
