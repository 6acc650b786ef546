// Finished rows on their way to a file or to memory, made by several threads and kept in order.
#pragma once
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "image/spectral_image.hpp"
#include "support/atomic_file.hpp"

namespace greenray {

/// Takes pieces of rows in any order, each once; they arrive at append() from the top downwards.
class PictureSink {
 public:
  virtual ~PictureSink() = default;
  /// rgb: [rows][width][3]. Safe to call from several threads.
  virtual void put(int first_row, int rows, std::vector<float> &&rgb) = 0;
  /// After the last row. errors: RunError (disk).
  virtual void finish() = 0;
};

/// Into an image in memory, which must outlive the sink and gets its size here.
std::unique_ptr<PictureSink> memory_sink(RgbImage &image, int width, int height);

/* Display-linear rows to PNG with sRGB, gAMA and cHRM chunks, as quantise() and write_png() make them: the same pixels,
   whatever the pieces. Pieces are compressed where they are made, each a run of the deflate stream of its own. */
std::unique_ptr<PictureSink> png_sink(AtomicFile &file, int width, int height, int bits = 8, bool dither = true);

/// Rows to EXR, FLOAT, Rec. 709; channels: as many as the values of a pixel; white_luminance_cd_m2: left out when 0.
std::unique_ptr<PictureSink> exr_sink(AtomicFile &file, int width, int height, double white_luminance_cd_m2,
                                      const std::vector<std::string> &channels = {"R", "G", "B"});

}  // namespace greenray
