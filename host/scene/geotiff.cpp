// read_geotiff: elevation models by libtiff, whose own tags tell no places; those of GeoTIFF are read here.
#include <filesystem>

#include "scene/height_tile.hpp"

#ifndef GREENRAY_WITH_TIFF

namespace greenray {
HeightTile read_geotiff(const std::string &path, const SourcePlace &asked_at) {
  throw InputError(asked_at, "'" + path + "': this greenray was built without libtiff and reads .hgt terrain only");
}
}  // namespace greenray

#else

#include <tiffio.h>

#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <mutex>

namespace greenray {
namespace {

// Tags and keys: OGC 19-008r4, annexes; GDAL_NODATA is GDAL's own.
constexpr std::uint32_t tag_pixel_scale = 33550, tag_tiepoint = 33922, tag_keys = 34735, tag_no_data = 42113;
constexpr int key_model = 1024, key_raster = 1025, key_angle_unit = 2054, key_vertical_unit = 4099;
constexpr std::uint64_t most_block_bytes = std::uint64_t{1} << 28;
constexpr int model_geographic = 2, raster_point = 2, unit_degree = 9102, unit_metre = 9001;

thread_local std::string tiff_said;

void remember(const char *, const char *format, va_list arguments) {
  char text[512];
  std::vsnprintf(text, sizeof text, format, arguments);
  if (tiff_said.empty()) tiff_said = text;
}

struct Close {
  void operator()(TIFF *tiff) const { TIFFClose(tiff); }
};

class GeoTiff {
 public:
  GeoTiff(const std::string &path, const SourcePlace &asked_at) : path_(path), asked_at_(asked_at) {
    static std::once_flag once;
    std::call_once(once, [] {
      TIFFSetErrorHandler(remember);
      TIFFSetWarningHandler(nullptr);  // unknown tags
    });
    tiff_said.clear();
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path, ignored))
      throw InputError(asked_at, "no such terrain file: '" + path + "'");
    tiff_.reset(TIFFOpen(path.c_str(), "r"));
    if (!tiff_) fail("not a TIFF file");
  }

  HeightTile read() {
    tile_.name = std::filesystem::path(path_).filename().string();
    read_layout();
    read_place();
    tile_.height_m.resize(static_cast<std::size_t>(tile_.rows) * static_cast<std::size_t>(tile_.columns));
    if (TIFFIsTiled(tiff_.get())) read_tiles();
    else read_lines();
    mark_voids();
    require_earthly(tile_, path_, asked_at_);
    tile_.fingerprint = fingerprint_of(tile_.height_m.data(), tile_.height_m.size() * sizeof(float));
    return std::move(tile_);
  }

 private:
  [[noreturn]] void fail(const std::string &what) const {
    throw InputError(asked_at_, "'" + path_ + "': " + what + (tiff_said.empty() ? "" : " (" + tiff_said + ")"));
  }

  /// Of a tag that libtiff does not know by itself, if the file has it with this type; else none.
  template <class Value>
  std::vector<Value> values(std::uint32_t tag, TIFFDataType type) const {
    std::uint32_t count = 0;
    Value *data = nullptr;
    const TIFFField *field = TIFFFieldWithTag(tiff_.get(), tag);
    if (!field || TIFFFieldDataType(field) != type || TIFFFieldReadCount(field) != TIFF_VARIABLE2) return {};
    if (TIFFGetField(tiff_.get(), tag, &count, &data) != 1 || !data) return {};
    return std::vector<Value>(data, data + count);
  }

  void read_layout() {
    std::uint32_t width = 0, height = 0;
    std::uint16_t bands = 1;
    TIFFGetField(tiff_.get(), TIFFTAG_IMAGEWIDTH, &width);
    TIFFGetField(tiff_.get(), TIFFTAG_IMAGELENGTH, &height);
    TIFFGetFieldDefaulted(tiff_.get(), TIFFTAG_SAMPLESPERPIXEL, &bands);
    TIFFGetFieldDefaulted(tiff_.get(), TIFFTAG_BITSPERSAMPLE, &bits_);
    TIFFGetFieldDefaulted(tiff_.get(), TIFFTAG_SAMPLEFORMAT, &format_);
    constexpr std::uint32_t most = 40000;
    if (width < 2 || height < 2 || width > most || height > most)
      fail("expected 2 to 40000 rows and columns, found " + std::to_string(height) + " x " + std::to_string(width));
    // No packing of bytes gains more: deflate's 1032.
    const double most_heights = 1100.0 * static_cast<double>(std::filesystem::file_size(path_));
    if (static_cast<double>(width) * height > most_heights) fail("more heights than the file can hold: cut short?");
    if (bands != 1) fail("expected one band of heights, found " + std::to_string(bands));
    const bool whole = format_ == SAMPLEFORMAT_INT || format_ == SAMPLEFORMAT_UINT;
    const bool real = format_ == SAMPLEFORMAT_IEEEFP;
    if (!(whole && (bits_ == 16 || bits_ == 32)) && !(real && (bits_ == 32 || bits_ == 64)))
      fail("expected heights as 16- or 32-bit whole numbers or 32- or 64-bit floats, found " + std::to_string(bits_) +
           " bits of another kind");
    tile_.columns = static_cast<int>(width), tile_.rows = static_cast<int>(height);
  }

  int key(const std::vector<std::uint16_t> &keys, int wanted, int otherwise) const {
    for (std::size_t i = 4; i + 3 < keys.size(); i += 4)
      if (keys[i] == wanted && keys[i + 1] == 0) return keys[i + 3];
    return otherwise;
  }

  void read_place() {
    const auto scale = values<double>(tag_pixel_scale, TIFF_DOUBLE), tie = values<double>(tag_tiepoint, TIFF_DOUBLE);
    const auto keys = values<std::uint16_t>(tag_keys, TIFF_SHORT);
    if (scale.size() < 2 || tie.size() < 6 || keys.size() < 4)
      fail("expected a GeoTIFF with ModelPixelScale, ModelTiepoint and GeoKeyDirectory");
    if (key(keys, key_model, 0) != model_geographic)
      fail("expected geographic coordinates (GTModelType 2: latitude and longitude), found GTModelType " +
           std::to_string(key(keys, key_model, 0)));
    if (key(keys, key_angle_unit, unit_degree) != unit_degree) fail("expected coordinates in degrees");
    if (key(keys, key_vertical_unit, unit_metre) != unit_metre) fail("expected heights in metres");
    if (!(scale[0] > 0 && scale[1] > 0 && std::isfinite(tie[3]) && std::isfinite(tie[4])))
      fail("expected a positive ModelPixelScale and a finite ModelTiepoint");
    const double half = key(keys, key_raster, 1) == raster_point ? 0 : 0.5;  // else the middle of an area
    tile_.column_deg = scale[0], tile_.row_deg = scale[1];
    tile_.west_deg = tie[3] + (half - tie[0]) * scale[0];
    const double north = tie[4] - (half - tie[1]) * scale[1];
    tile_.south_deg = north - scale[1] * (tile_.rows - 1);
    if (tile_.south_deg < -91 || north > 91 || tile_.west_deg < -361 || tile_.east_deg() > 541)
      fail("expected latitudes and longitudes in degrees, found places outside the Earth");
  }

  float number(const unsigned char *at) const {
    const auto as = [at](auto value) {
      std::copy(at, at + sizeof value, reinterpret_cast<unsigned char *>(&value));
      return static_cast<float>(value);
    };
    if (format_ == SAMPLEFORMAT_IEEEFP) return bits_ == 32 ? as(float{}) : as(double{});
    if (format_ == SAMPLEFORMAT_INT) return bits_ == 16 ? as(std::int16_t{}) : as(std::int32_t{});
    return bits_ == 16 ? as(std::uint16_t{}) : as(std::uint32_t{});
  }

  void put(int row, int column, const unsigned char *from, int count) {
    float *to = &tile_.height_m[static_cast<std::size_t>(row) * static_cast<std::size_t>(tile_.columns) +
                                static_cast<std::size_t>(column)];
    for (int i = 0; i < count; ++i) to[i] = number(from + i * (bits_ / 8));
  }

  void read_lines() {
    if (TIFFScanlineSize64(tiff_.get()) > most_block_bytes) fail("expected rows of less than 256 MiB");
    std::vector<unsigned char> line(static_cast<std::size_t>(TIFFScanlineSize64(tiff_.get())));
    if (line.size() < static_cast<std::size_t>(tile_.columns) * (bits_ / 8u)) fail("rows are shorter than they say");
    for (int row = 0; row < tile_.rows; ++row) {
      if (TIFFReadScanline(tiff_.get(), line.data(), static_cast<std::uint32_t>(row)) != 1)
        fail("row " + std::to_string(row) + " cannot be read: cut short?");
      put(row, 0, line.data(), tile_.columns);
    }
  }

  void read_tiles() {
    std::uint32_t width = 0, height = 0;
    TIFFGetField(tiff_.get(), TIFFTAG_TILEWIDTH, &width);
    TIFFGetField(tiff_.get(), TIFFTAG_TILELENGTH, &height);
    if (TIFFTileSize64(tiff_.get()) > most_block_bytes) fail("expected tiles of less than 256 MiB");
    std::vector<unsigned char> block(static_cast<std::size_t>(TIFFTileSize64(tiff_.get())));
    const int wide = static_cast<int>(width), high = static_cast<int>(height), bytes = bits_ / 8;
    if (width == 0 || height == 0 || block.size() < static_cast<std::size_t>(wide) * height * (bits_ / 8u))
      fail("tiles are smaller than they say");
    for (int top = 0; top < tile_.rows; top += high)
      for (int left = 0; left < tile_.columns; left += wide) {
        if (TIFFReadTile(tiff_.get(), block.data(), static_cast<std::uint32_t>(left), static_cast<std::uint32_t>(top),
                         0, 0) < 0)
          fail("the tile at row " + std::to_string(top) + " cannot be read: cut short?");
        for (int row = 0; row < std::min(high, tile_.rows - top); ++row)
          put(top + row, left, block.data() + static_cast<std::ptrdiff_t>(row) * wide * bytes,
              std::min(wide, tile_.columns - left));
      }
  }

  void mark_voids() {
    float no_data = -32768;  // what models have that name none
    const auto text = values<char>(tag_no_data, TIFF_ASCII);
    if (!text.empty()) no_data = std::strtof(std::string(text.begin(), text.end()).c_str(), nullptr);
    for (float &height : tile_.height_m)
      if (height == no_data || !std::isfinite(height)) height = std::numeric_limits<float>::quiet_NaN();
  }

  const std::string &path_;
  const SourcePlace &asked_at_;
  std::unique_ptr<TIFF, Close> tiff_;
  std::uint16_t bits_ = 0, format_ = 0;
  HeightTile tile_;
};

}  // namespace

HeightTile read_geotiff(const std::string &path, const SourcePlace &asked_at) { return GeoTiff(path, asked_at).read(); }

}  // namespace greenray

#endif
