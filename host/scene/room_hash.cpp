// room_hash: one number for everything that changes the picture.
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <iterator>

#include "scene/room_scene.hpp"
#include "support/embedded.hpp"
#include "support/toml_reader.hpp"

namespace greenray {
namespace {

/// FNV-1a with 64 bits (offset basis and prime of the FNV reference).
class Fingerprint {
 public:
  void add(const std::string &text) {
    for (const char c : text + "\n") {
      hash_ ^= static_cast<unsigned char>(c);
      hash_ *= 0x100000001b3u;
    }
  }
  void add(double value) { add(exact_decimal(value + 0.0)); }
  template <class List>
  void add_all(const List &values) {
    for (const double value : values) add(value);
  }
  void add(const Colour &c) {
    add(static_cast<double>(static_cast<int>(c.kind)));
    add_all(c.rgb);
    add(c.temperature_K);
  }
  std::string hex() const {
    char text[17];
    std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash_));
    return text;
  }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325u;
};

void add_surfaces(Fingerprint &print, const Surfaces &surfaces) {
  for (const Triangle &t : surfaces.triangles) {
    for (std::size_t c = 0; c < 3; ++c)
      print.add_all(t.corner[c]), print.add_all(t.corner_normal[c]), print.add_all(t.texture[c]);
    print.add(t.material), print.add(t.light);
  }
  for (const Sphere &s : surfaces.spheres)
    print.add_all(s.centre), print.add(s.radius_m), print.add(s.material), print.add(s.light);
}

void add_air(Fingerprint &print, const ProfileSpec &air) {
  print.add(air.base_is_us76), print.add(static_cast<int>(air.index)), print.add(air.exaggerate),
      print.add(air.surface_pressure_Pa);
  print.add(static_cast<int>(air.interpolation)), print.add(air.smooth_m);
  for (const Level &l : air.levels)
    print.add(l.height_m), print.add(l.temperature_K), print.add(l.pressure_Pa.value_or(-1)),
        print.add(l.relative_humidity.value_or(-1));
  for (const InversionSpec &i : air.inversions)
    print.add_all(i.delta_T_K.value), print.add_all(i.height_m.value), print.add_all(i.diffuseness_m.value);
  for (const SurfaceLayerSpec &l : air.surface_layers) print.add(l.delta_T_K), print.add(l.scale_m);
  for (const IndexLevel &l : air.index_levels) print.add(l.height_m), print.add(l.refractivity);
}

/// What only a Sun through the air depends on.
void add_sun(Fingerprint &print, const LightScene &l, const AtmosphereScene &above) {
  print.add(l.apparent), print.add(l.altitude_deg), print.add(l.site_height_m);
  add_air(print, above.profile);
  print.add(above.profile.earth_radius_m), print.add(above.extinction), print.add(above.ozone_DU);
  print.add(above.visibility_km.value_or(-1)), print.add(above.turbidity.value_or(-1));
  print.add(above.angstrom), print.add(above.aerosol_scale_height_m);
}

std::string bytes_of(const std::string &path) {
  if (std::ifstream file(path, std::ios::binary); file) return {std::istreambuf_iterator<char>(file), {}};
  return std::string(embedded_file(path).value_or(""));
}

}  // namespace

std::string room_hash(const RoomScene &scene) {
  Fingerprint print;
  if (scene.air) add_air(print, *scene.air);
  print.add(scene.extinction_per_m);
  const CameraScene &c = scene.camera;
  print.add_all(c.from), print.add_all(c.to), print.add_all(c.up), print.add(c.fov_deg), print.add_all(c.resolution);
  for (const MaterialScene &m : scene.materials) {
    print.add(static_cast<int>(m.kind)), print.add(m.reflectance), print.add(m.texture.value_or(-1));
    print.add(static_cast<int>(m.index.kind)), print.add_all(m.index.b), print.add_all(m.index.c_um2);
    print.add_all(m.conductor_n), print.add_all(m.conductor_k), print.add(m.roughness), print.add(m.absorption_per_m);
  }
  for (const TextureScene &t : scene.textures) print.add(bytes_of(t.path));
  add_surfaces(print, scene.surfaces);
  for (const LightScene &l : scene.lights) {
    print.add(static_cast<int>(l.kind)), print.add_all(l.from), print.add_all(l.direction), print.add(l.cone_deg);
    print.add(l.power_W), print.add(l.irradiance_W_m2), print.add(l.diameter_deg), print.add(l.colour);
    print.add(l.photon_weight), print.add(l.limb_darkening);
    if (l.through_air) add_sun(print, l, scene.above);
  }
  print.add(static_cast<double>(scene.photons.emitted)), print.add(scene.photons.gather);
  print.add(scene.photons.radius_m.value_or(-1)), print.add(scene.photons.most_bounces);
  print.add(scene.photons.precomputed), print.add(scene.photons.aimed), print.add(scene.photons.caustic_share);
  print.add_all(scene.spectrum.range_nm), print.add(scene.spectrum.samples);
  return print.hex();
}

}  // namespace greenray
