// All that is told about an eye in its air beside a picture: the air, its mirages, a fan of rays, a target.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "atmosphere/diagnosis.hpp"
#include "render/mirage.hpp"
#include "render/sight_line.hpp"

namespace greenray {

struct Target {
  double distance_m = 0, height_m = 0;
};

struct ViewRequest {
  double height_m = 0;  // of the eye
  std::vector<double> wavelengths_nm{diagnosis_wavelength_nm};
  bool flat = false;
  RayMethod method = RayMethod::cells;
  bool section = false;  // of air that varies along the surface
  double azimuth_rad = 0;
  std::optional<Target> target;
  std::optional<double> farthest_m;  // of the fan
  int fan_rays = 29;
};

/// The air at one height over the eye.
struct AirRow {
  double height_m, temperature_K, pressure_Pa;  // NaN for a medium given by its index
  double refractivity_N, modified_M;  // 1e6 (n - 1), 1e6 ((n - 1) + h/R): light is held where M falls with height
  double k;                           // ray curvature over the Earth's
};

struct FanRay {
  double apparent_altitude_deg = 0;
  int outcome = 0;  // space, ground, trapped: its end wherever that is
  std::vector<double> distance_m, height_m;
};

struct ViewDiagnosis {
  std::string profile;
  double height_m = 0, exaggerate = 1, earth_radius_m = 0;
  bool flat = false, varies = false;
  Diagnosis air;
  std::vector<AirRow> rows;
  double top_m = 0;  // of what is worth drawing
  double k_at_eye = 0;
  std::vector<Mirages> mirages;                                      // one a wavelength
  std::optional<double> horizon_deg, horizon_m;                      // apparent altitude; distance along the surface
  std::optional<double> geometric_horizon_deg, geometric_horizon_m;  // without air
  double fan_wavelength_nm = 0;
  std::vector<FanRay> fan;
  std::optional<SightLine> sight;
};

/// air: must outlive the call only. errors: InputError for impossible air, Interrupted when asked to stop.
ViewDiagnosis diagnose_view(const AirSection &air, const ViewRequest &request, const std::shared_ptr<Device> &device);

/// Height up to which the structure of this air and the eye reach [m]; 30 km if there is none.
double structure_top_m(const Profile &profile, const Diagnosis &diagnosis, std::optional<double> eye_height_m);

}  // namespace greenray
