// OpenEXR in and out: linear Rec. 709 in cd/m2, spectral radiance by wavelength, scalar channels in parts of their own.
#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "image/spectral_image.hpp"
#include "support/atomic_file.hpp"

namespace greenray {

/// Header attributes beyond the standard ones: scene text, seed, device, version, time, field of view.
using ExrAttributes = std::map<std::string, std::variant<std::string, double>>;

struct ExrOptions {
  bool spectral = true;  // write the S0.<nm> channels
};

struct ExrReport {
  std::size_t not_finite_replaced = 0;  // radiance values that were NaN or infinite: written as 0
};

/* Part 0: R, G, B (FLOAT, linear Rec. 709; luminance in cd/m2, `whiteLuminance` = 1) and `S0.550,000000nm` ... as in
   Fichet, Pacanowski & Wilkie 2021 (JCGT 10(3)): decimal comma, `spectralLayoutVersion` "1.0", `emissiveUnits`
   "W.m^-2.sr^-1". Each named scalar channel is a further part of that name with one channel of that name.
   image.radiance: W m^-2 sr^-1 nm^-1 (the layout's unit string leaves the per-nm implied)
   errors: RunError (disk); std::invalid_argument for arrays of the wrong length or reserved attribute names */
ExrReport write_exr(AtomicFile &file, const SpectralImage &image, const ExrAttributes &attributes = {},
                    const ExrOptions &options = {});
ExrReport write_exr(const std::filesystem::path &path, const SpectralImage &image, const ExrAttributes &attributes = {},
                    const ExrOptions &options = {});

/// A picture without spectra (developed or merged): R, G, B and the further channels as above.
void write_exr(AtomicFile &file, const RgbImage &image, const ExrAttributes &attributes = {});
void write_exr(const std::filesystem::path &path, const RgbImage &image, const ExrAttributes &attributes = {});

/// Channel name of a wavelength: "S0.550,000000nm".
std::string spectral_channel_name(double wavelength_nm);
/// Wavelength of an unpolarised emissive channel name (decimal comma or point; nm, um, m ... and Hz), or nothing.
std::optional<double> spectral_channel_wavelength_nm(const std::string &channel);

struct ExrPart {
  std::string name;
  int width = 0, height = 0;
  std::map<std::string, std::vector<float>> channels;  // each [height][width], HALF and UINT widened
};

/// An EXR file read whole.
struct ExrPicture {
  std::string file;
  std::vector<ExrPart> parts;
  ExrAttributes attributes;                     // string and number attributes of part 0
  std::optional<double> white_luminance_cd_m2;  // nothing: the file does not say what RGB (1,1,1) is
  std::array<double, 8> chromaticities{0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290};  // xy of R, G, B, white

  /// Linear Rec. 709 x whiteLuminance (1 if absent): from R,G,B, else X,Y,Z, else the spectra, else Y. InputError if
  /// none.
  RgbImage rgb() const;
  bool has_spectra() const;
  /// Spectra of part 0, wavelengths ascending; the one-channel parts as named channels. InputError without spectra.
  SpectralImage spectral() const;
};

/// errors: missing, not EXR, damaged or incomplete -> InputError `file:1:1: ...`
ExrPicture read_exr(const std::filesystem::path &path);

}  // namespace greenray
