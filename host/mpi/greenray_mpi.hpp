// What libgreenray-mpi.so offers. The tool loads it when mpirun started it, so that it needs no MPI otherwise.
#pragma once
#include "support/ranks.hpp"

extern "C" {
/// Version of greenray that it was built with.
const char *greenray_mpi_version();
/// Joins the others; null: that failed. Valid until greenray_mpi_finish.
greenray::Ranks *greenray_mpi_start();
/// All leave together: waits for the others.
void greenray_mpi_finish();
/// Ends the others, too, wherever they are. Does not return.
void greenray_mpi_abort(int code);
}
