// Pictures read a few rows at a time, so that their size is no matter: EXR of any writer, Radiance .hdr, or memory.
#pragma once
#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "image/spectral_image.hpp"

namespace greenray {

/// What a picture says about itself.
struct PictureFacts {
  std::string name;
  int width = 0, height = 0;
  std::vector<double> wavelength_nm;  // ascending; empty: the planes are X, Y, Z (CIE 1931)
  bool absolute = true;               // false: the luminance of its unit is not known
  bool rec709 = false;                // the planes are linear Rec. 709 in place of X, Y, Z
  std::optional<double> fov_deg;      // horizontal width seen by the observer
  std::vector<std::string> notes;     // what had to be assumed

  bool spectral() const { return !wavelength_nm.empty(); }
  std::size_t planes() const { return spectral() ? wavelength_nm.size() : 3; }
  std::size_t pixels() const { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }
};

class PictureSource {
 public:
  virtual ~PictureSource() = default;
  const PictureFacts &facts() const { return facts_; }
  /* Rows first .. first+rows-1 into planes [plane][row][x]: spectral radiance [W m^-2 sr^-1 nm^-1], or X, Y, Z [cd/m2].
     Values are as the file has them: NaN, infinities and negative ones included. Safe to call from several threads.
     errors: damaged pixels -> InputError */
  virtual void read(int first, int rows, std::vector<float> &planes) = 0;

 protected:
  PictureFacts facts_;
};

struct SourceOptions {
  std::optional<double> unit_cd_m2;  // luminance of RGB (1,1,1) or Y = 1; replaces what the file says
  bool spectra = true;               // false: colours of the file, though it has spectra
  bool rec709 = false;               // true: an EXR in Rec. 709 stays so, bit for bit (facts().rec709)
};

/* EXR (first part: S0.<nm> spectra, else R,G,B with `chromaticities` and `whiteLuminance`, else X,Y,Z, else Y) or
   Radiance picture, told apart by their first bytes. errors: missing, damaged, of another kind, without colour ->
   InputError `file:1:1: ...` */
std::unique_ptr<PictureSource> open_picture(const std::filesystem::path &path, const SourceOptions &options = {});
std::unique_ptr<PictureSource> open_exr(const std::filesystem::path &path, const SourceOptions &options);
/// Radiance RGBE or XYZE, run-length coded or flat; EXPOSURE, COLORCORR, PRIMARIES, VIEW; 179 lm/W.
std::unique_ptr<PictureSource> open_radiance(const std::filesystem::path &path, const SourceOptions &options);

/// Pictures in memory, which must outlive the source.
std::unique_ptr<PictureSource> picture_source(const RgbImage &rec709_cd_m2, std::optional<double> fov_deg);
std::unique_ptr<PictureSource> picture_source(const SpectralImage &image, std::optional<double> fov_deg);

/// The whole picture, or some rows of it [rows][width][3], linear Rec. 709.
RgbImage read_rgb(PictureSource &source);
std::vector<float> read_rgb_rows(PictureSource &source, int first, int rows);

using Matrix3 = std::array<std::array<double, 3>, 3>;
/// XYZ of RGB by primaries and white (x, y of R, G, B, white); (1,1,1) has Y = 1. InputError-free: NaN if they are
/// flat.
Matrix3 xyz_of_primaries(const std::array<double, 8> &chromaticities);
/// planes x3 in place.
void transform_planes(const Matrix3 &matrix, std::vector<float> &planes);

}  // namespace greenray
