// Pictures of a view's diagnosis: the air with its ducts, a fan of rays, the transfer curve with its branches numbered.
#pragma once
#include <optional>
#include <string>

#include "image/svg.hpp"
#include "render/view_diagnosis.hpp"

namespace greenray {

/// Temperature, refractivity and modified refractivity, ray curvature against height; ducts shaded, the eye's level
/// drawn.
Plot air_figure(const ViewDiagnosis &view);
/// Height against distance, exaggerated; colours by where rays end.
Plot fan_figure(const ViewDiagnosis &view);
/// Seen against true altitude, branches numbered, folds marked; beside it how often each true altitude is seen.
Plot transfer_figure(const ViewDiagnosis &view);

/// How often each true altitude is seen, over the same axis.
Plot count_figure(const ViewDiagnosis &view);

/// All of them, one below the other, as one SVG document. rays: drawn in place of the fan.
std::string view_sheet(const ViewDiagnosis &view, const std::optional<Plot> &rays = std::nullopt);

}  // namespace greenray
