// Rows of a sky picture, band by band, alone or shared out to workers.
#pragma once
#include <functional>

#include "render/sky_run.hpp"

namespace greenray {

/* Calls shade(first, last, run) until all rows of the run are in the picture. Workers take strips of rows in turn and
   send them to worker 0, whose picture and file they go into; where bands stop by themselves (`adaptive`) it makes them
   alone. errors: those of shade, after what is done was kept; RanksLost at workers that did not fail themselves */
void run_rows(Ranks &ranks, bool adaptive, SkyRun &run, SkyPicture &picture, int rows_a_band,
              const std::function<void(int first, int last, SkyRun &run)> &shade);

}  // namespace greenray
