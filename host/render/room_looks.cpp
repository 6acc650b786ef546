#include "render/room_looks.hpp"

#include <algorithm>
#include <cmath>

#include "image/exr.hpp"
#include "image/png.hpp"
#include "render/room_sun.hpp"
#include "scene/room_frame.hpp"
#include "support/csv_table.hpp"
#include "support/error.hpp"

namespace greenray {
namespace {

/// Planck's law, relative.
double blackbody(double wavelength_nm, double temperature_K) {
  const double l = 1e-9 * wavelength_nm;
  return 1 / (std::pow(l / 5.5e-7, 5) * std::expm1(0.014387768775 / (l * temperature_K)));
}

class Builder {
 public:
  explicit Builder(const RoomScene &scene) : scene_(scene), d65_(CsvTable::embedded("host/data/cie_d65_5nm.csv")) {
    out_.wavelength_nm = room_wavelengths(scene);
    add_row([](double nm) { return curve_place(nm); });  // ROW_WAVE_PLACE
    for (const TextureScene &texture : scene.textures) add_texture(texture);
    for (const MaterialScene &material : scene.materials) add_material(material);
    for (std::size_t i = 0; i < scene.lights.size(); ++i) add_light(static_cast<int>(i));
  }
  RoomLooks take() { return std::move(out_); }

 private:
  template <class F>
  int add_row(const F &value) {
    for (const double nm : out_.wavelength_nm) out_.spectra.push_back(static_cast<float>(value(nm)));
    return static_cast<int>(out_.spectra.size() / out_.waves()) - 1;
  }

  int add_reflectance(const Colour &colour) {
    const bool is_grey = colour.rgb[0] == colour.rgb[1] && colour.rgb[1] == colour.rgb[2];
    if (is_grey) return add_row([&](double) { return colour.rgb[0]; });
    const CurveCoefficients c = uplift_.coefficients(colour.rgb);
    return add_row([&](double nm) { return curve_value(c, nm); });
  }

  void add_material(const MaterialScene &from) {
    using Kind = MaterialScene::Kind;
    room_twin::Material m{};
    m.kind = static_cast<int>(from.kind);
    m.reflectance = m.index = m.extinction = m.absorption = m.texture = -1;
    m.roughness = static_cast<float>(from.roughness);
    const bool glass = from.kind == Kind::dielectric || from.kind == Kind::rough_dielectric;
    if (glass) {
      m.index = add_row([&](double nm) { return from.index.at(nm); });
      m.disperses = from.index.disperses() && out_.waves() > 1;
      if (from.absorption_per_m > 0) m.absorption = add_row([&](double) { return from.absorption_per_m; });
    } else {
      m.reflectance = add_reflectance(from.reflectance);
      if (from.texture) m.texture = *from.texture;
    }
    if (from.kind == Kind::rough_conductor) {
      m.index = add_row([&](double nm) { return of_three(from.conductor_n, nm); });
      m.extinction = add_row([&](double nm) { return of_three(from.conductor_k, nm); });
    }
    out_.materials.push_back(m);
  }

  /// Straight lines between 465, 532 and 630 nm; constant beyond.
  static double of_three(const std::array<double, 3> &at_630_532_465, double nm) {
    const auto [red, green, blue] = at_630_532_465;
    if (nm >= 532) return green + std::min((nm - 532) / (630 - 532), 1.0) * (red - green);
    return blue + std::max((nm - 465) / (532 - 465), 0.0) * (green - blue);
  }

  void add_texture(const TextureScene &from) {
    room_twin::Texture t{};
    t.first = static_cast<int>(out_.texels.size());
    const RgbImage picture = read_linear(from);
    t.width = picture.width, t.height = picture.height;
    for (int row = picture.height - 1; row >= 0; --row)  // v = 0 is the lowest row
      for (int column = 0; column < picture.width; ++column) {
        const auto at =
            static_cast<std::size_t>(row) * static_cast<std::size_t>(picture.width) + static_cast<std::size_t>(column);
        const CurveCoefficients c = uplift_.coefficients(picture.pixel(at));
        out_.texels.push_back({static_cast<float>(c[0]), static_cast<float>(c[1]), static_cast<float>(c[2]), 0});
      }
    out_.textures.push_back(t);
  }

  static RgbImage read_linear(const TextureScene &from) {
    if (from.path.size() > 4 && from.path.substr(from.path.size() - 4) == ".exr") return read_exr(from.path).rgb();
    const Raster raster = read_png(from.path);
    RgbImage picture{raster.width, raster.height, {}};
    const double full = raster.bits == 16 ? 65535 : 255;
    for (const std::uint16_t value : raster.rgb) picture.rgb.push_back(static_cast<float>(srgb_decode(value / full)));
    return picture;
  }

  std::vector<double> shape_of(const Colour &colour) {
    std::vector<double> shape;
    const double brightest = std::max({colour.rgb[0], colour.rgb[1], colour.rgb[2]});
    const bool tinted = colour.kind == Colour::Kind::rgb && brightest > 0;
    const CurveCoefficients c =
        tinted ? uplift_.coefficients({colour.rgb[0] / brightest, colour.rgb[1] / brightest, colour.rgb[2] / brightest})
               : CurveCoefficients{};
    for (const double nm : out_.wavelength_nm) {
      if (colour.kind == Colour::Kind::blackbody) shape.push_back(blackbody(nm, colour.temperature_K));
      else
        shape.push_back(d65_.interpolate("nm", "S", nm, CsvTable::Outside::clamp) * (tinted ? curve_value(c, nm) : 1));
    }
    return shape;
  }

  /// Integral over the wavelengths of samples joined by straight lines; of one: 1 nm.
  double integral(const std::vector<double> &shape) const {
    if (shape.size() == 1) return shape[0];
    double sum = 0;
    for (std::size_t w = 1; w < shape.size(); ++w)
      sum += 0.5 * (shape[w] + shape[w - 1]) * (out_.wavelength_nm[w] - out_.wavelength_nm[w - 1]);
    return sum;
  }

  void add_light(int number) {
    LightScene from = scene_.lights[static_cast<std::size_t>(number)];
    using Kind = LightScene::Kind;
    std::vector<double> shape;  // [wavelengths] of its power
    if (from.through_air) shape = bring_through_air(from);
    else shape = shape_of(from.colour);
    room_twin::Light light{};
    light.versine = 2;
    light.glass = glass_around_light(scene_, number);
    light.limb = from.limb_darkening ? add_limb() : 0;
    place(from, light);
    double power_W = from.power_W;
    if (from.kind == Kind::sun) power_W = cover_scene(from, light);
    if (from.kind == Kind::area) take_primitives(number, light);
    light.kind = from.kind == Kind::point  ? room_twin::LIGHT_POINT
                 : from.kind == Kind::spot ? room_twin::LIGHT_SPOT
                 : from.kind == Kind::area ? room_twin::LIGHT_AREA
                                           : room_twin::LIGHT_SUN;
    const double whole = integral(shape);
    std::size_t w = 0;
    double sum = 0;
    light.power = add_row([&](double) {
      const double value = power_W * shape[w++] / whole;
      sum += value;
      return value;
    });
    out_.light_power_W_nm.push_back(sum);
    out_.lights.push_back(light);
  }

  /// Direction and irradiance of a Sun that shines through the air. returns: its spectrum
  std::vector<double> bring_through_air(LightScene &from) const {
    const RoomSun sun = sun_through_air(scene_, from, out_.wavelength_nm);
    from.direction = travel_from(sun.apparent_altitude_deg, from.azimuth_deg);
    from.irradiance_W_m2 = integral(sun.irradiance_W_m2_nm);
    return sun.irradiance_W_m2_nm;
  }

  /// returns: the first of the rows, one for each power of mu
  int add_limb() {
    int first = 0;
    for (const std::vector<double> &row : limb_rows(out_.wavelength_nm)) {
      std::size_t w = 0;
      const int at = add_row([&](double) { return row[w++]; });
      if (first == 0) first = at;
    }
    return first;
  }

  static void place(const LightScene &from, room_twin::Light &light) {
    for (std::size_t a = 0; a < 3; ++a) {
      light.place[a] = static_cast<float>(from.from[a]);
      light.direction[a] = static_cast<float>(from.direction[a]);
    }
    const double half_deg = from.kind == LightScene::Kind::spot  ? from.cone_deg / 2
                            : from.kind == LightScene::Kind::sun ? from.diameter_deg / 2
                                                                 : 180;
    light.versine = static_cast<float>(2 * std::pow(std::sin(half_deg * M_PI / 360), 2));  // 1 - cos
  }

  /// A disk that the whole scene lies behind. returns: the power through it [W]
  double cover_scene(const LightScene &from, room_twin::Light &light) const {
    Triple low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
    const auto include = [&](const Triple &p, double r) {
      for (std::size_t a = 0; a < 3; ++a) low[a] = std::min(low[a], p[a] - r), high[a] = std::max(high[a], p[a] + r);
    };
    for (const Triangle &t : scene_.surfaces.triangles)
      for (const Triple &c : t.corner) include(c, 0);
    for (const Sphere &s : scene_.surfaces.spheres) include(s.centre, s.radius_m);
    const Triple centre = 0.5 * (low + high);
    const double reach = 0.5 * length(high - low);
    // Rays that lean by the Sun's radius must still cover all of it.
    const double radius = reach * (1 + 2.5 * std::tan(from.diameter_deg * M_PI / 360)) + 1e-6;
    light.radius_m = static_cast<float>(radius);
    for (std::size_t a = 0; a < 3; ++a)
      light.place[a] = static_cast<float>(centre[a] - 1.01 * reach * from.direction[a]);
    return from.irradiance_W_m2 * M_PI * radius * radius;
  }

  void take_primitives(int number, room_twin::Light &light) {
    light.first_primitive = static_cast<int>(out_.light_primitives.size());
    std::vector<std::pair<int, double>> areas;
    const auto &triangles = scene_.surfaces.triangles;
    const auto &spheres = scene_.surfaces.spheres;
    for (std::size_t i = 0; i < triangles.size(); ++i)
      if (triangles[i].light == number) areas.emplace_back(static_cast<int>(i), length(triangles[i].area_vector_m2()));
    for (std::size_t i = 0; i < spheres.size(); ++i)
      if (spheres[i].light == number)
        areas.emplace_back(static_cast<int>(triangles.size() + i),
                           4 * M_PI * spheres[i].radius_m * spheres[i].radius_m);
    double whole = 0, running = 0;
    for (const auto &[primitive, area] : areas) whole += area;
    for (const auto &[primitive, area] : areas) {
      running += area;
      out_.light_primitives.push_back({static_cast<float>(running / whole), primitive});
    }
    light.primitives = static_cast<int>(areas.size());
    light.area_m2 = static_cast<float>(whole);
    light.radiance_share = static_cast<float>(1 / (M_PI * whole));
  }

  const RoomScene &scene_;
  CsvTable d65_;
  Uplift uplift_;
  RoomLooks out_;
};

}  // namespace

std::vector<double> room_wavelengths(const RoomScene &scene) {
  const auto [from, to] = scene.spectrum.range_nm;
  std::vector<double> nm;
  for (int i = 0; i < scene.spectrum.samples; ++i)
    nm.push_back(scene.spectrum.samples == 1 ? 0.5 * (from + to)
                                             : from + (to - from) * i / (scene.spectrum.samples - 1));
  return nm;
}

RoomLooks room_looks(const RoomScene &scene) { return Builder(scene).take(); }

void share_photons(RoomLooks &looks, std::uint32_t photons, const std::vector<double> &weights) {
  double whole = 0, running = 0;
  for (const double weight : weights) whole += weight;
  std::uint32_t first = 0;
  for (std::size_t i = 0; i < looks.lights.size(); ++i) {
    running += weights[i];
    // Each light has one photon at least; the last takes what is left.
    const auto lights_left = static_cast<std::uint32_t>(looks.lights.size() - i - 1);
    auto end = static_cast<std::uint32_t>(std::llround(static_cast<double>(photons) * running / whole));
    end = std::clamp(end, first + 1, std::max(first + 1, photons - lights_left));
    if (lights_left == 0) end = photons;
    looks.lights[i].first_photon = first;
    looks.lights[i].photons = end - first;
    first = end;
  }
}

void share_photons(RoomLooks &looks, std::uint32_t photons) {
  share_photons(looks, photons, std::vector<double>(looks.light_power_W_nm));
}

}  // namespace greenray
