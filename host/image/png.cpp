#include "image/png.hpp"

#include <png.h>

#include <algorithm>
#include <cmath>
#include <csetjmp>
#include <memory>
#include <stdexcept>
#include <string>

#include "image/colour.hpp"
#include "support/error.hpp"
#include "support/fast_math.hpp"

namespace greenray {

namespace {

/// PCG output function of a counter: the same noise whatever the order of pixels.
std::uint32_t hashed(std::uint32_t value) {
  const std::uint32_t state = value * 747796405U + 2891336453U;
  const std::uint32_t word = ((state >> ((state >> 28U) + 4U)) ^ state) * 277803737U;
  return (word >> 22U) ^ word;
}

/// In [0, 1), 24 bits.
float uniform(std::uint32_t value) {
  return static_cast<float>(static_cast<std::int32_t>(hashed(value) >> 8U)) * (1.0F / 16777216.0F);
}

/// libpng reports by longjmp; the message waits here, on the heap, until we are back in C++.
struct PngProblem {
  char message[200] = "";
};

void on_error(png_structp png, png_const_charp message) {
  auto *problem = static_cast<PngProblem *>(png_get_error_ptr(png));
  std::snprintf(problem->message, sizeof problem->message, "%s", message);
  png_longjmp(png, 1);
}

void on_warning(png_structp, png_const_charp) {}

void append_bytes(png_structp png, png_bytep bytes, png_size_t count) {
  auto *all = static_cast<std::vector<char> *>(png_get_io_ptr(png));
  all->insert(all->end(), bytes, bytes + count);
}

void no_flush(png_structp) {}

/// Rows as PNG stores them: big-endian.
std::vector<png_byte> png_bytes(const Raster &raster) {
  if (raster.bits == 8) return {raster.rgb.begin(), raster.rgb.end()};
  std::vector<png_byte> bytes;
  bytes.reserve(2 * raster.rgb.size());
  for (const std::uint16_t value : raster.rgb) {
    bytes.push_back(static_cast<png_byte>(value >> 8U));
    bytes.push_back(static_cast<png_byte>(value & 0xFFU));
  }
  return bytes;
}

/// Everything with a destructor is the caller's, so a longjmp out of libpng skips none.
bool encode(png_structp png, png_infop info, const Raster &raster, const std::vector<png_bytep> &rows) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_set_IHDR(png, info, static_cast<png_uint_32>(raster.width), static_cast<png_uint_32>(raster.height), raster.bits,
               PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_sRGB_gAMA_and_cHRM(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
  png_write_info(png, info);
  png_write_image(png, const_cast<png_bytepp>(rows.data()));
  png_write_end(png, info);
  return true;
}

/// First half of reading: header and conversions to plain RGB, or RGB and alpha.
bool decode_header(png_structp png, png_infop info, std::FILE *stream, bool with_alpha) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_init_io(png, stream);
  png_read_info(png, info);
  png_set_expand(png);
  png_set_gray_to_rgb(png);
  if (with_alpha) png_set_add_alpha(png, 0xffff, PNG_FILLER_AFTER);
  else png_set_strip_alpha(png);
  png_read_update_info(png, info);
  return true;
}

bool decode_rows(png_structp png, const std::vector<png_bytep> &rows) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_read_image(png, const_cast<png_bytepp>(rows.data()));
  png_read_end(png, nullptr);
  return true;
}

std::vector<png_bytep> row_pointers(std::vector<png_byte> &bytes, std::size_t height) {
  std::vector<png_bytep> rows(height);
  for (std::size_t y = 0; y < height; ++y) rows[y] = bytes.data() + y * (bytes.size() / height);
  return rows;
}

struct Reader {
  PngProblem problem;
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &problem, on_error, on_warning);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  Reader() = default;
  Reader(const Reader &) = delete;
  Reader &operator=(const Reader &) = delete;
  ~Reader() { png_destroy_read_struct(&png, &info, nullptr); }
};

}  // namespace

/// Levels of the sRGB curve, not yet rounded; linear: NaN counts as 0.
GREENRAY_VECTOR_CLONES static void encode_levels(const float *linear, std::size_t count, float full, float *levels) {
  for (std::size_t i = 0; i < count; ++i) {
    const float x = linear[i] > 0 ? (linear[i] < 1 ? linear[i] : 1.0F) : 0.0F;
    const float curve = 1.055F * fast_pow(x > 0.0031308F ? x : 0.0031308F, 1.0F / 2.4F) - 0.055F;
    levels[i] = x >= 1 ? full : full * (x <= 0.0031308F ? 12.92F * x : curve);
  }
}

/// Triangular noise of +-1 step with a fixed seed; it narrows towards 0 and full, which stay exact.
GREENRAY_VECTOR_CLONES static void add_noise(std::uint32_t first_sample, std::size_t count, float full, float *levels) {
  constexpr std::uint32_t seed = 0x9E3779B9U;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t counter = 2U * (first_sample + static_cast<std::uint32_t>(i));
    const float noise = uniform(counter ^ seed) - uniform((counter + 1U) ^ seed);
    const float above = levels[i] < 1.0F ? levels[i] : 1.0F, below = full - levels[i];
    levels[i] += noise * (above < below ? above : below);
  }
}

GREENRAY_VECTOR_CLONES static void round_levels(const float *levels, std::size_t count, std::uint16_t *to) {
  for (std::size_t i = 0; i < count; ++i)
    to[i] = static_cast<std::uint16_t>(static_cast<std::int32_t>(levels[i] + 0.5F));
}

void quantise_samples(const float *display_linear, std::size_t count, std::size_t first_sample, int bits, bool dither,
                      std::uint16_t *levels) {
  const float full = bits == 8 ? 255.0F : 65535.0F;
  constexpr std::size_t block = 256;
  float exact[block];
  for (std::size_t begin = 0; begin < count; begin += block) {
    const std::size_t some = std::min(block, count - begin);
    encode_levels(display_linear + begin, some, full, exact);
    if (dither) add_noise(static_cast<std::uint32_t>(first_sample + begin), some, full, exact);
    round_levels(exact, some, levels + begin);
  }
}

Raster quantise(const RgbImage &display_linear, int bits, bool dither) {
  if (bits != 8 && bits != 16) throw std::invalid_argument("a PNG has 8 or 16 bits");
  Raster raster{display_linear.width, display_linear.height, bits, {}};
  raster.rgb.resize(display_linear.rgb.size());
  quantise_samples(display_linear.rgb.data(), raster.rgb.size(), 0, bits, dither, raster.rgb.data());
  return raster;
}

std::vector<char> encode_png(const Raster &raster) {
  const std::size_t samples = 3 * static_cast<std::size_t>(raster.width) * static_cast<std::size_t>(raster.height);
  if (samples == 0 || raster.rgb.size() != samples || (raster.bits != 8 && raster.bits != 16))
    throw std::invalid_argument("PNG pixels do not fit the size of the picture");
  std::vector<png_byte> bytes = png_bytes(raster);
  const std::vector<png_bytep> rows = row_pointers(bytes, static_cast<std::size_t>(raster.height));
  std::vector<char> encoded;
  PngProblem problem;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &problem, on_error, on_warning);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  bool done = false;
  if (info) {
    png_set_write_fn(png, &encoded, append_bytes, no_flush);
    done = encode(png, info, raster, rows);
  }
  png_destroy_write_struct(&png, &info);
  if (!done) throw RunError(std::string("libpng cannot encode a picture: ") + problem.message);
  return encoded;
}

void write_png(AtomicFile &file, const Raster &raster) {
  const std::vector<char> encoded = encode_png(raster);
  file.write(encoded.data(), encoded.size());
}

void write_png(const std::filesystem::path &path, const Raster &raster) {
  AtomicFile file(path);
  write_png(file, raster);
  file.commit();
}

Raster read_png(const std::filesystem::path &path, std::vector<std::uint16_t> *alpha) {
  const SourcePlace place{path.string(), 1, 1};
  const std::unique_ptr<std::FILE, int (*)(std::FILE *)> stream(std::fopen(path.c_str(), "rb"), &std::fclose);
  if (!stream) throw InputError(place, "expected a PNG file, found no readable file");
  Reader reader;
  if (!reader.info) throw RunError("libpng " PNG_LIBPNG_VER_STRING " does not start");
  const auto damaged = [&] {
    return InputError(place, std::string("not a readable PNG file (") + reader.problem.message + ")");
  };
  if (!decode_header(reader.png, reader.info, stream.get(), alpha != nullptr)) throw damaged();
  Raster raster;
  raster.width = static_cast<int>(png_get_image_width(reader.png, reader.info));
  raster.height = static_cast<int>(png_get_image_height(reader.png, reader.info));
  raster.bits = png_get_bit_depth(reader.png, reader.info);
  const auto height = static_cast<std::size_t>(raster.height);
  std::vector<png_byte> bytes(height * png_get_rowbytes(reader.png, reader.info));
  if (!decode_rows(reader.png, row_pointers(bytes, height))) throw damaged();
  const std::size_t sample_bytes = raster.bits == 16 ? 2 : 1, samples = bytes.size() / sample_bytes;
  const std::size_t channels = alpha ? 4 : 3;
  raster.rgb.reserve(samples / channels * 3);
  for (std::size_t i = 0; i < samples; ++i) {
    const int level = sample_bytes == 1 ? bytes[i] : bytes[2 * i] << 8 | bytes[2 * i + 1];
    (i % channels == 3 ? *alpha : raster.rgb).push_back(static_cast<std::uint16_t>(level));
  }
  return raster;
}

}  // namespace greenray
