// Pictures of `greenray profile --plot` and `greenray trace --plot`.
#pragma once
#include <optional>
#include <vector>

#include "atmosphere/diagnosis.hpp"
#include "image/svg.hpp"
#include "render/refraction.hpp"

namespace greenray::cli {

/// Temperature, pressure, n-1 and its gradient against height, up to where the structure of this air ends.
Plot air_plot(const Profile &profile, const Diagnosis &diagnosis, const std::vector<double> &wavelengths_nm,
              std::optional<double> eye_height_m);

/// Height of the plot: two and a half times the highest layer the profile or the diagnosis knows, 30 km if there is
/// none.
double plot_top_m(const Profile &profile, const Diagnosis &diagnosis, std::optional<double> eye_height_m);

/* Height above the surface against distance along it, a line for each altitude and wavelength.
   rows: of trace_table, with the distances of each ray ascending; a ray that ends between two distances is drawn to
         where it ends, along the mean of its last two elevations */
Plot ray_plot(const std::vector<TraceRow> &rows, const TraceRequest &request, const Profile &profile);

}  // namespace greenray::cli
