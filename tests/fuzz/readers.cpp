#include "fuzz/readers.hpp"

#include <unistd.h>

#include <fstream>
#include <sstream>
#include <stdexcept>

#include "atmosphere/profile.hpp"
#include "atmosphere/profile_file.hpp"
#include "bench/record.hpp"
#include "image/alpha_picture.hpp"
#include "image/exr.hpp"
#include "image/picture_source.hpp"
#include "image/png.hpp"
#include "render/room_checkpoint.hpp"
#include "render/transfer_curve.hpp"
#include "scene/job_list.hpp"
#include "scene/obj_check.hpp"
#include "scene/obj_file.hpp"
#include "scene/room_scene.hpp"
#include "scene/scene_file.hpp"
#include "support/csv_table.hpp"
#include "support/error.hpp"

namespace greenray::fuzz {
namespace {

namespace fs = std::filesystem;

/// A file with these bytes while it is read.
class FileOf {
 public:
  FileOf(const Bytes &bytes, const std::string &extension)
      : path_(fs::temp_directory_path() / ("greenray-fuzz-" + std::to_string(getpid()) + extension)) {
    std::ofstream(path_, std::ios::binary) << bytes;
  }
  ~FileOf() { fs::remove(path_); }
  const fs::path &path() const { return path_; }

 private:
  fs::path path_;
};

Bytes contents(const fs::path &path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}
std::vector<Bytes> contents_of(const fs::path &folder, const std::string &extension) {
  std::vector<Bytes> all;
  for (const auto &entry : fs::recursive_directory_iterator(fs::path(GREENRAY_SOURCE) / folder))
    if (entry.path().extension() == extension) all.push_back(contents(entry.path()));
  return all;
}
template <class Write>
Bytes written(const std::string &extension, Write write) {
  const FileOf file("", extension);
  write(file.path());
  return contents(file.path());
}

/// n and its slope where the air changes: a profile that is accepted must also be usable.
void use_air(const ProfileSpec &spec) {
  if (has_places(spec)) return;
  const Profile air(spec);
  for (const double h : {0.0, 1.0, 1e3, 3e4})
    if (h <= air.top_m(false)) (void)air.refractivity(h, 550);
}

void read_scene(const Bytes &bytes) { (void)parse_scene("fuzz.toml", bytes); }
void read_room(const Bytes &bytes) { (void)parse_room(GREENRAY_SOURCE "/scenes/fuzz.toml", bytes); }
void read_profile(const Bytes &bytes) { use_air(parse_profile("fuzz.toml", bytes)); }
void read_soundings(const Bytes &bytes) { use_air(parse_profile("fuzz.txt", bytes)); }
void read_sounding_csv(const Bytes &bytes) { use_air(parse_profile("fuzz.csv", bytes)); }
void read_obj(const Bytes &bytes) {
  (void)parse_obj("fuzz.obj", bytes, [&](const std::string &) { return std::optional<std::string>(bytes); });
}
void read_jobs(const Bytes &bytes) {
  (void)parse_jobs(bytes.find("[[job]]") != Bytes::npos ? "fuzz.toml" : "fuzz.csv", bytes);
}
void read_table(const Bytes &bytes) { (void)CsvTable::parse(bytes, "fuzz.csv"); }
void read_picture(const Bytes &bytes) {
  const FileOf file(bytes, ".exr");
  const auto source = open_picture(file.path());
  std::vector<float> planes;
  const int height = source->facts().height, rows = std::min(height, 16);
  if (source->facts().pixels() > 1u << 22) return;  // a true large one: streamed elsewhere
  for (int y = 0; y < height; y += rows) source->read(y, std::min(rows, height - y), planes);
}
void read_whole_exr(const Bytes &bytes) {
  const FileOf file(bytes, ".exr");
  (void)read_exr(file.path());
}
void read_png_file(const Bytes &bytes) {
  const FileOf file(bytes, ".png");
  (void)read_alpha_picture(file.path());
}
void read_checkpoint_file(const Bytes &bytes) {
  const FileOf file(bytes, ".grck");
  (void)read_checkpoint(file.path());
}
void read_curve(const Bytes &bytes) {
  const FileOf file(bytes, ".csv");
  (void)read_transfer_curve(file.path());
}
void read_records(const Bytes &bytes) {
  const FileOf file(bytes, ".json");
  (void)bench::read_results(file.path());
}

SpectralImage small_picture() {
  SpectralImage image;
  image.width = 5, image.height = 3, image.wavelength_nm = {450, 550, 650};
  for (int i = 0; i < 45; ++i) image.radiance.push_back(0.1f * static_cast<float>(i));
  return image;
}
std::vector<Bytes> exr_seeds() {
  RgbImage rgb;
  rgb.width = 4, rgb.height = 2, rgb.rgb.assign(24, 0.5f);
  return {written(".exr", [](const fs::path &path) { write_exr(path, small_picture()); }),
          written(".exr", [&](const fs::path &path) { write_exr(path, rgb); })};
}
std::vector<Bytes> picture_seeds() {
  std::vector<Bytes> seeds = exr_seeds();
  Bytes radiance =
      "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=2.5\nPRIMARIES=0.64 0.33 0.3 0.6 0.15 0.06 0.31 0.33\n\n-Y 2 +X "
      "8\n";
  for (int y = 0; y < 2; ++y) {
    radiance += Bytes("\x02\x02\x00\x08", 4);
    for (int c = 0; c < 4; ++c) radiance += Bytes("\x88\x40", 2);
  }
  seeds.push_back(radiance);
  seeds.push_back("#?RGBE\n\n-Y 1 +X 2\n" + Bytes("\x10\x20\x30\x80\x40\x50\x60\x81", 8));
  return seeds;
}
std::vector<Bytes> png_seeds() {
  Raster raster{4, 3, 8, std::vector<std::uint16_t>(36, 99)}, deep{2, 2, 16, std::vector<std::uint16_t>(12, 999)};
  return {written(".png", [&](const fs::path &path) { write_png(path, raster); }),
          written(".png", [&](const fs::path &path) { write_png(path, deep); })};
}
std::vector<Bytes> checkpoint_seeds() {
  return {written(".grck", [](const fs::path &path) { write_checkpoint(path, RoomCheckpoint{}); })};
}
std::vector<Bytes> scene_seeds() {
  std::vector<Bytes> seeds;
  for (Bytes &text : contents_of("scenes", ".toml"))
    if (!is_room_text("fuzz.toml", text)) seeds.push_back(std::move(text));
  return seeds;
}
std::vector<Bytes> room_seeds() {
  std::vector<Bytes> seeds;
  for (Bytes &text : contents_of("scenes", ".toml"))
    if (is_room_text("fuzz.toml", text)) seeds.push_back(std::move(text));
  return seeds;
}
std::vector<Bytes> profile_seeds() { return contents_of("profiles", ".toml"); }
std::vector<Bytes> sounding_seeds() { return contents_of("tests/data/soundings", ".txt"); }
std::vector<Bytes> sounding_csv_seeds() { return contents_of("tests/data/soundings", ".csv"); }
std::vector<Bytes> obj_seeds() {
  return {
      "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nusemtl a\nf 1/1/1 2/1/1 3//1 4\nf -1 -2 -3\n"
      "newmtl a\nKd 0.5 0.5 0.5\nmap_Kd t.png\n",
      "o x\ng y\ns 1\nv 0 0 0\nv 2 0 0\nv 2 2 0\nv 1 0.5 0\nv 0 2 0\nf 1 2 3 4 5\nl 1 2\n"};
}
std::vector<Bytes> job_seeds() {
  return {"scene,name,sun.altitude_deg\nflat-sun,a,0.5\nflat-sun,b,\"-0.25\"\n",
          "[[job]]\nscene = \"flat-sun\"\nsun.altitude_deg = 0.5\n[[job]]\nscene = \"split-sun\"\nname = \"x\"\n"};
}
std::vector<Bytes> table_seeds() { return {"# a table\nwavelength_nm,value\n400,1\n500,2.5e0\n600,-3\n"}; }
std::vector<Bytes> curve_seeds() { return contents_of("tests/data/fuzz", ".csv"); }
std::vector<Bytes> record_seeds() { return contents_of("bench/results", ".json"); }

}  // namespace

const std::vector<Reader> &readers() {
  static const std::vector<Reader> all{
      {"scene",
       {"[sun]", "[[target]]", "altitude_deg", "= -", "nan", "{", "[", "\"", "1e999"},
       read_scene,
       scene_seeds},
      {"room",
       {"[[quad]]", "[[light]]", "corner", "= -", "nan", "[[material]]", "[", "\"", "1e999"},
       read_room,
       room_seeds},
      {"profile", {"[[level]]", "[[inversion]]", "height_m", "= -", "nan", "[", "1e999"}, read_profile, profile_seeds},
      {"sounding", {"-9999", "-8888", "9999", "#", "-----", "PRES", "\r", "NaN"}, read_soundings, sounding_seeds},
      {"sounding-csv",
       {"height_m", "temperature_K", ",", ",,", "NaN", "\r\n", "-9999"},
       read_sounding_csv,
       sounding_csv_seeds},
      {"obj",
       {"f ", "v ", "vt ", "vn ", "mtllib ", "usemtl ", "newmtl ", "Kd ", "/", "//", "-1", "nan"},
       read_obj,
       obj_seeds},
      {"jobs", {"scene", "[[job]]", ",", "\"", "name", "= "}, read_jobs, job_seeds},
      {"table", {",", "#", "nan", "1e999", "\n\n"}, read_table, table_seeds},
      {"picture", {"#?RADIANCE", "-Y ", "+X ", "\n\n", "EXPOSURE="}, read_picture, picture_seeds},
      {"exr", {"channels", "compression", "dataWindow", "tiles"}, read_whole_exr, exr_seeds},
      {"png", {"IHDR", "IDAT", "tRNS", "PLTE"}, read_png_file, png_seeds},
      {"checkpoint", {}, read_checkpoint_file, checkpoint_seeds},
      {"curve", {",", "space", "ground", "nan"}, read_curve, curve_seeds},
      {"records", {"{", "}", "[", "null", "\"rate\"", "1e999"}, read_records, record_seeds},
  };
  return all;
}

Answer feed(const Reader &reader, const Bytes &bytes, std::string *refusal) {
  try {
    reader.read(bytes);
    return Answer::read;
  } catch (const Error &error) {
    if (refusal) *refusal = error.what();
    if (*error.what() == 0) throw std::logic_error(reader.name + ": an error that says nothing");
    return Answer::refused;
  }
}

}  // namespace greenray::fuzz
