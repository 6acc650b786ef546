// A scene with surfaces becomes a spectral picture: curved photons into two maps, curved eye paths, gathered pass by
// pass. G04 section 3.
#pragma once
#include <filesystem>
#include <memory>
#include <optional>

#include "atmosphere/air_table.hpp"
#include "compute/room_tracer.hpp"
#include "image/spectral_image.hpp"
#include "render/renderer.hpp"
#include "scene/room_scene.hpp"

namespace greenray {

class Ranks;

struct RoomOptions {
  std::uint32_t seed = 1;
  bool straight = false;  // no bending, for comparison
  std::array<int, 2> size{};
  std::optional<std::array<int, 4>> crop;  // x0, y0, x1, y1 in pixels, x1 and y1 excluded
  SourcePlace crop_place{"command line", 1, 1};
  std::optional<int> spp;               // samples a pixel in all (4); at least one in every pass
  std::optional<std::int64_t> photons;  // emitted in all, in place of the scene's number
  int passes = 0;                       // independent ones, each with its share of the photons; 0: chosen
  /// With one of these: passes until the estimated error of a pixel (RMS, noise and bias, over the mean) is below, or
  /// until the time is up, earlier sessions of the same picture counted; spp and photons are then limits as well.
  std::optional<double> error_pct, minutes;
  std::int64_t photon_map = 0;  // photons in the picture of the photon map; 0: no such picture
  /// Where to keep what there is; empty: nowhere. Written when `checkpoint_seconds` have passed since the last one and
  /// when the run ends by an interrupt or an error.
  std::filesystem::path checkpoint;
  double checkpoint_seconds = 60;
  enum class Resume { when_it_fits, always, never } resume = Resume::when_it_fits;
  std::function<void(const std::string &phase, double fraction, double noise)> progress;
  std::function<void(const std::string &)> note;  // something the user should know
};

struct RoomReport {
  PhotonTotals photons;
  std::size_t triangles = 0, spheres = 0, air_cells = 1;
  double table_error_m = 0;  // of places on a path across the scene
  double noise_rms = 0;      // of a pixel's standard error, relative to the mean radiance
  double bias_rms = 0;       // of a pixel's bias, the same way
  double bias_below = 0;     // with what the noise may hide of it
  bool bias_is_seen = false;
  double bias_mean = 0;                     // of the whole picture, with its sign
  double error_rms = 0;                     // both together
  double error_of_rms = 0;                  // the same over the RMS of the picture
  int passes = 0, spp = 0, resumed_at = 0;  // resumed_at: passes taken from a checkpoint
  int workers = 1;                          // that made it together
  std::int64_t photons_a_pass = 0;
  std::size_t aimed_cells = 0;  // of the lights' emission, that caustic photons are aimed at; 0: they are not
  std::size_t lamp_pixels = 0, edge_pixels = 0;  // with more samples: at the edges of lamps, of light and dark
  double build_seconds = 0, emit_seconds = 0, map_seconds = 0, gather_seconds = 0, eye_seconds = 0, compile_seconds = 0;
  double table_arcsec = 0, solver_arcsec = 0;  // of directions (render/room_error.hpp)
  double cover_seconds = 0;                    // part of gather_seconds
};

struct RoomPicture {
  SpectralImage image;  // channels: depth_m, bend_mrad, photon_count, noise (standard error of the band mean) and bias
  RoomReport report;
  /// The photon map by itself (render/photon_picture.hpp), of the first pass that was made now: power of the photons in
  /// each pixel [W/nm]; its channel photon_count is their number. Empty unless asked for.
  std::optional<SpectralImage> photon_map;
};

/// The scene's medium for its wavelengths; n = 1 everywhere without one, or when straight.
AirTable room_air(const RoomScene &scene, const std::vector<double> &wavelength_nm, bool straight);

/// errors: InputError (textures, media that need too many cells, a checkpoint of another picture), MemoryError,
/// Interrupted
RoomPicture render_room(const RoomScene &scene, const RoomOptions &options, const std::shared_ptr<Device> &device);
/// With other workers that call it with the same scene and options: at rank 0 the picture, elsewhere an empty one.
RoomPicture render_room(const RoomScene &scene, const RoomOptions &options, const std::shared_ptr<Device> &device,
                        Ranks &ranks);
/// On several devices at once, a thread each.
RoomPicture render_room(const RoomScene &scene, const RoomOptions &options,
                        const std::vector<std::shared_ptr<Device>> &devices);

}  // namespace greenray
