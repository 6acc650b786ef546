// Terrain files and the keys of [terrain]: bytes made here, places on the ellipsoid, and what is said about wrong ones.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "scene/height_tile.hpp"
#include "scene/scene_file.hpp"
#include "support_code/terrain.hpp"

namespace greenray {
namespace {

namespace fs = std::filesystem;
using testing_terrain::GeoTiffBytes;
using testing_terrain::hgt_bytes;

class TerrainFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "greenray-terrain-XXXXXX").string();
    ASSERT_NE(::mkdtemp(name.data()), nullptr);
    folder = name;
  }
  void TearDown() override { fs::remove_all(folder); }

  std::string file(const std::string &name, const std::string &bytes) const {
    std::ofstream(folder / name, std::ios::binary) << bytes;
    return (folder / name).string();
  }

  /// What is said about a file; "" when it is right.
  static std::string said_of(const std::string &path) {
    try {
      read_height_tile(path, {"scene.toml", 7, 9});
    } catch (const InputError &error) {
      EXPECT_EQ(error.diagnostics().size(), 1u);
      EXPECT_EQ(error.diagnostics()[0].place.line, 7);
      EXPECT_EQ(error.diagnostics()[0].place.column, 9);
      return error.diagnostics()[0].message;
    }
    return "";
  }

  Scene scene(const std::string &more, const std::string &observer) const {
    const std::string text = "greenray = 1\n[atmosphere]\nprofile = \"us76\"\n[observer]\n" + observer +
                             "\nazimuth_deg = 0.0\nfov_deg = 2.0\nresolution = [64, 48]\n[terrain]\n" + more;
    return parse_scene((folder / "scene.toml").string(), text);
  }
  std::string said_of_scene(const std::string &more, const std::string &observer) const {
    try {
      scene(more, observer);
    } catch (const InputError &error) {
      EXPECT_EQ(error.diagnostics().size(), 1u) << error.what();
      return error.diagnostics()[0].text();
    }
    return "";
  }

  fs::path folder;
};

int ramp(int row, int column) { return 4 * (row % 500) - column % 300; }

}  // namespace

// oracle: the bytes, written here from a formula; corners by the name (SRTM: south-western corner, rows from the north)
// tolerance: none
TEST_F(TerrainFiles, TilesOfTheShuttleMissionAreReadByteByByte) {
  for (const int side : {1201, 3601}) {
    const HeightTile t = read_height_tile(file("S34W071.hgt", hgt_bytes(side, ramp)), {});
    EXPECT_EQ(t.rows, side);
    EXPECT_EQ(t.columns, side);
    EXPECT_DOUBLE_EQ(t.south_deg, -34);
    EXPECT_DOUBLE_EQ(t.west_deg, -71);
    EXPECT_NEAR(t.north_deg(), -33, 1e-12);
    EXPECT_NEAR(t.east_deg(), -70, 1e-12);
    for (const auto &[row, column] : {std::pair{0, 0}, {0, side - 1}, {side - 1, 0}, {499, 299}, {777, 1000}})
      EXPECT_EQ(t.at(row, column), static_cast<float>(ramp(row, column))) << row << " " << column;
  }
}

// oracle: -32768 is SRTM's void; the height between four nodes is bilinear, worked out by hand
// tolerance: rounding of floats at heights of some metres
TEST_F(TerrainFiles, HeightsBetweenNodesAreBilinearAndVoidsAreNotHeights) {
  const auto heights = [](int row, int column) {
    if (row == 600 && column == 600) return -32768;
    return row == 1200 && column == 0 ? 10 : row == 1200 && column == 1 ? 20 : row == 1199 && column == 0 ? 30 : 40;
  };
  const HeightField field({read_height_tile(file("n46e007.hgt", hgt_bytes(1201, heights)), {})});
  std::size_t hint = 0;
  float height = 0;
  const double node = 1.0 / 1200;
  ASSERT_EQ(field.height({46 + 0.25 * node, 7 + 0.5 * node}, height, hint), HeightField::Cover::land);
  EXPECT_NEAR(height, 0.75 * 15 + 0.25 * 35, 1e-4);
  EXPECT_EQ(field.height({46.5 + 0.3 * node, 7.5 + 0.3 * node}, height, hint), HeightField::Cover::void_);
  EXPECT_EQ(field.height({47.2, 7.5}, height, hint), HeightField::Cover::none);
  EXPECT_EQ(degree_square({-33.2, -70.1}), "S34W071");
  EXPECT_EQ(degree_square({46.0, 187.5}), "N46W173");
}

// oracle: slopes of a plane, known; metres per degree of the sphere of 6371 km, within 0.6 % of the ellipsoid's
// tolerance: those 0.6 %
TEST(Terrain, SlopesOfAPlane) {
  const double east = 0.2, north = -0.1, per_deg = 111195;
  const HeightTile tile = testing_terrain::tile_of(46, 7, 1e-3, 101, 101, [&](const GeoPlace &p) {
    return 2000 + north * per_deg * (p.latitude_deg - 46) +
           east * per_deg * std::cos(to_rad(46.05)) * (p.longitude_deg - 7);
  });
  const HeightField field({tile});
  Relief at;
  std::size_t hint = 0;
  for (const GeoPlace &place : {GeoPlace{46.05, 7.05}, GeoPlace{46.0002, 7.0003}, GeoPlace{46.1, 7.1}}) {
    ASSERT_EQ(field.relief(place, at, hint), HeightField::Cover::land);
    EXPECT_NEAR(at.slope_east, east, 0.006 * east);
    EXPECT_NEAR(at.slope_north, north, 0.006 * 0.1);
  }
}

TEST_F(TerrainFiles, AWrongTileHasOneClearComplaint) {
  const std::string right = hgt_bytes(1201, ramp);
  EXPECT_EQ(said_of(file("N46E007.SRTMGL3.hgt", right)), "");
  EXPECT_NE(said_of(file("N46E007.hgt", right.substr(0, 1000000))).find("found 1000000 (cut short"), std::string::npos);
  EXPECT_NE(said_of(file("N46E008.hgt", right + "x")).find("expected 2884802 bytes"), std::string::npos);
  EXPECT_NE(said_of(file("alps.hgt", right)).find("such as N46E007.hgt"), std::string::npos);
  EXPECT_NE(said_of(file("N46E0071.hgt", right)).find("such as N46E007.hgt"), std::string::npos);
  EXPECT_NE(said_of(file("N99E007.hgt", right)).find("such as N46E007.hgt"), std::string::npos);
  EXPECT_NE(said_of((folder / "N47E007.hgt").string()).find("no such terrain file"), std::string::npos);
  EXPECT_NE(said_of(file("N46E007.dem", right)).find("ends in .hgt (SRTM), .tif"), std::string::npos);
  const std::string swapped = hgt_bytes(1201, [](int, int) { return 0x0140 << 0; });
  std::string little = swapped;
  for (std::size_t i = 0; i < little.size(); i += 2) std::swap(little[i], little[i + 1]);
  EXPECT_EQ(said_of(file("N46E009.hgt", swapped)), "");
  EXPECT_NE(said_of(file("N46E010.hgt", little)).find("wrong byte order"), std::string::npos);
}

// oracle: the text, line by line; a corner is half a cell outside the first node, a centre is the node
// tolerance: none but rounding of the places
TEST_F(TerrainFiles, GridsOfHeightsAsText) {
  const std::string heights = "10 20 30\n40 -9 60.5\n";
  const HeightTile corner = read_height_tile(
      file("corner.asc", "NCOLS 3\nnrows 2\nxllcorner 7.0\nyllcorner 46.0\ncellsize 0.5\nNODATA_value -9\n" + heights),
      {});
  EXPECT_EQ(corner.rows, 2);
  EXPECT_EQ(corner.columns, 3);
  EXPECT_DOUBLE_EQ(corner.west_deg, 7.25);
  EXPECT_DOUBLE_EQ(corner.south_deg, 46.25);
  EXPECT_DOUBLE_EQ(corner.north_deg(), 46.75);
  EXPECT_EQ(corner.at(0, 2), 30.0f);
  EXPECT_EQ(corner.at(1, 2), 60.5f);
  EXPECT_TRUE(std::isnan(corner.at(1, 1)));
  const std::string header = "ncols 3\nnrows 2\nxllcenter 7.0\nyllcenter 46.0\ncellsize 0.5\n";
  EXPECT_DOUBLE_EQ(read_height_tile(file("centre.asc", header + heights), {}).west_deg, 7);

  const auto said = [&](const std::string &text) {
    try {
      read_height_tile(file("wrong.asc", text), {});
    } catch (const InputError &error) {
      EXPECT_EQ(error.diagnostics().size(), 1u);
      return error.diagnostics()[0].text();
    }
    return std::string();
  };
  EXPECT_NE(said(header + "10 20 30\n40 50\n").find("found 5: cut short"), std::string::npos);
  EXPECT_NE(said(header + heights + "70\n").find("asc:8:1: expected the end after 6"), std::string::npos);
  EXPECT_NE(said(header + "10 20 high\n40 50 60\n").find("asc:6:7: expected a height"), std::string::npos);
  EXPECT_NE(said("ncols 3\nnrows 2\nxllcenter 7\nyllcenter 46\n" + heights).find("'cellsize'"), std::string::npos);
  EXPECT_NE(said("ncols 3\nrows 2\n").find("asc:2:1: expected one of"), std::string::npos);
  EXPECT_NE(said("ncols 3\nnrows 2\nxllcenter 7e5\nyllcenter 5e6\ncellsize 30\n" + heights).find("outside the Earth"),
            std::string::npos);
}

#ifdef GREENRAY_WITH_TIFF
// oracle: the tags, written here byte by byte (TIFF 6.0, OGC 19-008r4): the tiepoint is a corner of a pixel's area, or
// its middle
// tolerance: none but rounding of the places
TEST_F(TerrainFiles, ElevationModelsInGeographicCoordinates) {
  GeoTiffBytes tiff;
  for (int i = 0; i < 12; ++i) tiff.heights.push_back(static_cast<float>(100.25 + i));
  tiff.no_data = "105.25";
  const HeightTile area = read_height_tile(file("area.tif", tiff.bytes()), {});
  EXPECT_EQ(area.rows, 3);
  EXPECT_EQ(area.columns, 4);
  EXPECT_NEAR(area.west_deg, 10.25, 1e-12);
  EXPECT_NEAR(area.north_deg(), 48 - 0.125, 1e-12);
  EXPECT_NEAR(area.south_deg, 48 - 0.625, 1e-12);
  EXPECT_EQ(area.at(0, 0), 100.25f);
  EXPECT_EQ(area.at(2, 3), 111.25f);
  EXPECT_TRUE(std::isnan(area.at(1, 1)));

  GeoTiffBytes point;
  point.raster = 2, point.tiepoint = {1, 1, 0, 10.5, 48, 0};
  for (int i = 0; i < 12; ++i) point.whole.push_back(static_cast<std::int16_t>(i == 7 ? -32768 : 7 * i - 30));
  const HeightTile node = read_height_tile(file("point.tiff", point.bytes()), {});
  EXPECT_NEAR(node.west_deg, 10, 1e-12);
  EXPECT_NEAR(node.north_deg(), 48.25, 1e-12);
  EXPECT_EQ(node.at(0, 1), -23.0f);
  EXPECT_TRUE(std::isnan(node.at(1, 3)));
}

TEST_F(TerrainFiles, AWrongElevationModelHasOneClearComplaint) {
  GeoTiffBytes right;
  right.heights.assign(12, 100.0f);
  const auto said = [&](const char *name, const auto &change) {
    GeoTiffBytes tiff = right;
    change(tiff);
    return said_of(file(name, tiff.bytes()));
  };
  EXPECT_EQ(said("right.tif", [](GeoTiffBytes &) {}), "");
  EXPECT_NE(said("utm.tif", [](GeoTiffBytes &t) { t.model = 1; }).find("geographic coordinates"), std::string::npos);
  EXPECT_NE(said("plain.tif", [](GeoTiffBytes &t) { t.scale.clear(); }).find("ModelPixelScale"), std::string::npos);
  EXPECT_NE(said("metres.tif", [](GeoTiffBytes &t) { t.tiepoint[4] = 5e6; }).find("outside the Earth"),
            std::string::npos);
  EXPECT_NE(said("high.tif", [](GeoTiffBytes &t) { t.heights[3] = 3e4f; }).find("-500 to 9000 m"), std::string::npos);
  EXPECT_NE(said_of(file("short.tif", right.bytes().substr(0, 200))).find("short.tif'"), std::string::npos);
  EXPECT_NE(said_of(file("text.tif", "heights")).find("not a TIFF file"), std::string::npos);
}
#else
TEST_F(TerrainFiles, WithoutItsLibraryAnElevationModelIsRefused) {
  EXPECT_NE(said_of(file("dem.tif", GeoTiffBytes{}.bytes())).find("built without libtiff"), std::string::npos);
}
#endif

// oracle: the geodesic as the path of a particle on the ellipsoid, its acceleration along the normal alone (Runge &
// Kutta's fourth order, steps of 100 m, in Earth-centred coordinates)
// tolerance: 1 mm, as the header says
TEST(Terrain, GeodesicsLeadWhereFreeMotionOnTheEllipsoidDoes) {
  using testing_terrain::dot;
  using testing_terrain::on_ellipsoid;
  using testing_terrain::Vector;
  const double a2 = testing_terrain::wgs84_major_m * testing_terrain::wgs84_major_m;
  const double b2 = a2 * std::pow(1 - testing_terrain::wgs84_flattening, 2);
  struct State {
    Vector r, v;
  };
  const auto derivative = [&](const State &s) {
    const Vector n{s.r[0] / a2, s.r[1] / a2, s.r[2] / b2}, nv{s.v[0] / a2, s.v[1] / a2, s.v[2] / b2};
    const double pull = -dot(nv, s.v) / dot(n, n);
    return State{s.v, {pull * n[0], pull * n[1], pull * n[2]}};
  };
  const auto moved = [](const State &s, const State &d, double h) {
    State out = s;
    for (std::size_t i = 0; i < 3; ++i) out.r[i] += h * d.r[i], out.v[i] += h * d.v[i];
    return out;
  };
  for (const GeoPlace &from : {GeoPlace{46.6, 7.9}, GeoPlace{-0.5, -78.4}, GeoPlace{78.2, 15.6}})
    for (const double azimuth : {0.0, 0.7, 2.0, 4.4}) {
      const double lat = to_rad(from.latitude_deg), lon = to_rad(from.longitude_deg);
      const double north = std::cos(azimuth), east = std::sin(azimuth);
      State s{on_ellipsoid(from),
              {-north * std::sin(lat) * std::cos(lon) - east * std::sin(lon),
               -north * std::sin(lat) * std::sin(lon) + east * std::cos(lon), north * std::cos(lat)}};
      const double h = 100;
      for (int i = 1; i <= 3000; ++i) {
        const State k1 = derivative(s), k2 = derivative(moved(s, k1, h / 2)), k3 = derivative(moved(s, k2, h / 2)),
                    k4 = derivative(moved(s, k3, h));
        for (const auto &[k, w] : {std::pair{k1, 1.0}, {k2, 2.0}, {k3, 2.0}, {k4, 1.0}}) s = moved(s, k, h * w / 6);
        if (i != 300 && i != 3000) continue;
        const Vector ours = on_ellipsoid(geodesic_place(from, azimuth, i * h));
        const Vector off = testing_terrain::minus(ours, s.r);
        EXPECT_LT(std::sqrt(dot(off, off)), 1e-3) << from.latitude_deg << " " << azimuth << " " << i * h;
      }
    }
}

// oracle: what the keys say: the eye above the ground under it, or above the sea
// tolerance: none
TEST_F(TerrainFiles, TheEyeStandsOnItsTerrain) {
  file("N46E007.hgt", hgt_bytes(1201, [](int, int) { return 1500; }));
  const std::string tiles = "tiles = [\"N46E007.hgt\"]\nfarthest_m = 20e3\n";
  const std::string place = "place = { latitude_deg = 46.5, longitude_deg = 7.5 }\n";
  EXPECT_DOUBLE_EQ(scene(tiles, place + "above_ground_m = 1.7").observer.height_m, 1501.7);
  EXPECT_DOUBLE_EQ(scene(tiles, place + "height_m = 1600").observer.height_m, 1600);
  EXPECT_DOUBLE_EQ(scene(tiles, place + "height_m = 1600").terrain.ground_m, 1500);
  EXPECT_NE(scene_hash(scene(tiles, place + "height_m = 1600")), scene_hash(scene(tiles, place + "height_m = 1601")));
}

TEST_F(TerrainFiles, WrongTerrainInASceneHasOneClearComplaint) {
  file("N46E007.hgt", hgt_bytes(1201, [](int row, int) { return row == 600 ? -32768 : 1500; }));
  file("N46E008.hgt", "short");
  const std::string tiles = "tiles = [\"N46E007.hgt\"]\n", eye = "height_m = 1600\n";
  const std::string place = eye + "place = { latitude_deg = 46.25, longitude_deg = 7.5 }";
  EXPECT_EQ(said_of_scene(tiles, place), "");
  const auto expect = [&](const std::string &more, const std::string &observer, const char *says) {
    EXPECT_NE(said_of_scene(more, observer).find(says), std::string::npos) << said_of_scene(more, observer);
  };
  expect(tiles, eye, "'observer.place': expected { latitude_deg");
  expect("farthest_m = 5000", place, "missing key 'terrain.tiles'");
  expect("tiles = []", place, "one file at least");
  expect("tiles = [\"N46E008.hgt\"]", place, "cut short");
  expect("tiles = [\"N45E008.hgt\"]", place, "no such terrain file");
  expect("tiles = [3]", place, "an array of texts");
  expect(tiles, "place = { latitude_deg = 46.25, longitude_deg = 7.5 }\nheight_m = 1499",
         "below the terrain, which is 1500");
  expect(tiles, "place = { latitude_deg = 46.5, longitude_deg = 7.5 }\nheight_m = 1600", "no height there");
  expect(tiles, "place = { latitude_deg = 47.5, longitude_deg = 7.5 }\nheight_m = 1600", "none of them has N47E007");
  expect(tiles, place + "\nabove_ground_m = 2", "found both");
  expect(tiles + "reflectance = [1, 2]", place, "from 0 to 1");
  expect(tiles + "[tracing]\ntransfer = \"per-pixel\"", place, "per-pixel");
}

}  // namespace greenray
