// Sums over passes become the picture of a room and what its report says of errors. Needs no device.
#pragma once
#include "render/room_plan.hpp"
#include "render/room_tally.hpp"

namespace greenray {

/// report: what is known of the run; what follows from the sums is put into it.
RoomPicture picture_of(const RoomPlan &plan, const std::vector<double> &wavelength_nm, const RoomTally &tally,
                       const RoomReport &report);

/// Relative to the mean of the crop.
PixelStatistics::Totals totals_of(const RoomPlan &plan, const PixelStatistics &pixels);

}  // namespace greenray
