// A scene with surfaces becomes a spectral picture: curved photons into two maps, curved eye paths, gathered pass by
// pass. G04 section 3.
#pragma once
#include <memory>

#include "atmosphere/air_table.hpp"
#include "compute/room_tracer.hpp"
#include "image/spectral_image.hpp"
#include "render/renderer.hpp"
#include "scene/room_scene.hpp"

namespace greenray {

struct RoomOptions {
  std::uint32_t seed = 1;
  bool straight = false;  // no bending, for comparison
  std::array<int, 2> size{};
  int spp = 4;     // of the whole picture; at least one in every pass
  int passes = 4;  // independent ones, each with its share of the photons
  std::function<void(const std::string &phase, double fraction)> progress;
};

struct RoomReport {
  PhotonTotals photons;
  std::size_t triangles = 0, spheres = 0, air_cells = 1;
  double table_error_m = 0;  // of places on a path across the scene
  double noise_rms = 0;      // of a pixel, relative to the mean radiance, from the spread of the passes
  double bias = 0;           // relative: what kernels of half the area see differently, in blocks of 8x8 pixels
  int passes = 0, spp = 0;
  double build_seconds = 0, emit_seconds = 0, map_seconds = 0, gather_seconds = 0, eye_seconds = 0, compile_seconds = 0;
  double table_arcsec = 0, solver_arcsec = 0;  // of directions (render/room_error.hpp)
  double cover_seconds = 0;                    // part of gather_seconds
};

struct RoomPicture {
  SpectralImage image;  // channels: depth_m, bend_mrad, photon_count, noise (standard error of the band mean)
  RoomReport report;
};

/// The scene's medium for its wavelengths; n = 1 everywhere without one, or when straight.
AirTable room_air(const RoomScene &scene, const std::vector<double> &wavelength_nm, bool straight);

/// errors: InputError (textures, media that need too many cells), MemoryError, Interrupted
RoomPicture render_room(const RoomScene &scene, const RoomOptions &options, const std::shared_ptr<Device> &device);

}  // namespace greenray
