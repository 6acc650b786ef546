// Pictures that cover only a part of their area.
#pragma once
#include <filesystem>
#include <vector>

#include "image/spectral_image.hpp"

namespace greenray {

/// Colours in linear Rec. 709 not yet multiplied by what they cover.
struct AlphaPicture {
  RgbImage colours;
  std::vector<float> alpha;  // [height][width], 0 .. 1
};

/* PNG (sRGB, with or without alpha) or EXR (R, G, B multiplied by A as OpenEXR has it; without A all is covered).
   errors: missing, damaged, of another kind -> InputError `file:1:1: ...` */
AlphaPicture read_alpha_picture(const std::filesystem::path &path);

}  // namespace greenray
