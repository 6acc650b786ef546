// EXR rows on demand.
#include <ImfChannelList.h>
#include <ImfChromaticities.h>
#include <ImfDoubleAttribute.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfPartType.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>

#include "image/exr.hpp"
#include "image/exr_chunks.hpp"
#include "image/picture_source.hpp"
#include "support/error.hpp"
#include "support/parallel.hpp"

namespace greenray {
namespace fs = std::filesystem;

namespace {

InputError complaint(const fs::path &path, const std::string &message) {
  return InputError(SourcePlace{path.string(), 1, 1}, message);
}

std::optional<double> number_attribute(const Imf::Header &header, const char *name) {
  if (const auto *real = header.findTypedAttribute<Imf::DoubleAttribute>(name)) return real->value();
  if (const auto *single = header.findTypedAttribute<Imf::FloatAttribute>(name))
    return static_cast<double>(single->value());
  return std::nullopt;
}

class ExrSource : public PictureSource {
 public:
  ExrSource(const fs::path &path, const SourceOptions &options) : path_(path) {
    file_ = std::make_unique<Imf::MultiPartInputFile>(path.c_str());
    part_ = std::make_unique<Imf::InputPart>(*file_, 0);
    const Imf::Header &header = file_->header(0);
    if (header.hasType() && Imf::isDeepData(header.type()))
      throw complaint(path, "deep EXR pictures are not supported");
    if (!file_->partComplete(0)) throw complaint(path, "incomplete EXR file: some rows of pixels are missing");
    window_ = header.dataWindow();
    facts_.name = path.string();
    check_size(header);
    choose_channels(header, options);
    read_geometry(header);
    chunks_ = ExrChunks::open(path);
    if (chunks_) part_.reset(), file_.reset();
    else if (Imf::globalThreadCount() == 0) Imf::setGlobalThreadCount(static_cast<int>(host_threads()));
  }

  void read(int first, int rows, std::vector<float> &planes) override {
    const auto width = static_cast<std::size_t>(facts_.width);
    const std::size_t count = static_cast<std::size_t>(rows) * width;
    planes.resize(count * channels_.size());
    try {
      if (chunks_) chunks_->read(first, rows, channels_, planes.data());
      else read_tiles(first, rows, count, planes);
    } catch (const std::exception &problem) {
      throw complaint(path_, std::string("not a readable EXR file (") + problem.what() + ")");
    }
    if (facts_.spectral()) return;
    if (channels_.size() == 1) spread_grey(planes, count);
    transform_planes(to_xyz_, planes);
  }

 private:
  void read_tiles(int first, int rows, std::size_t count, std::vector<float> &planes) {
    const int top = window_.min.y + first;
    Imf::FrameBuffer frame;
    for (std::size_t k = 0; k < channels_.size(); ++k) {
      const Imath::V2i origin(window_.min.x, top);
      frame.insert(channels_[k], Imf::Slice::Make(Imf::FLOAT, planes.data() + k * count, origin, facts_.width, rows));
    }
    const std::lock_guard<std::mutex> guard(lock_);
    part_->setFrameBuffer(frame);
    part_->readPixels(top, top + rows - 1);
  }

  /// A damaged header can claim any size; no compression of OpenEXR shrinks pixels more than about 1000 times.
  void check_size(const Imf::Header &header) {
    const std::int64_t width = std::int64_t{window_.max.x} - window_.min.x + 1;
    const std::int64_t height = std::int64_t{window_.max.y} - window_.min.y + 1;
    std::size_t channels = 0;
    for (auto it = header.channels().begin(); it != header.channels().end(); ++it) ++channels;
    constexpr std::int64_t most = 1 << 17;
    const double bytes = 2.0 * static_cast<double>(width) * static_cast<double>(height) * static_cast<double>(channels);
    if (width < 1 || height < 1 || width > most || height > most ||
        bytes > 2000.0 * static_cast<double>(fs::file_size(path_)) + 1e6)
      throw complaint(
          path_, "damaged EXR file: it claims " + std::to_string(width) + "x" + std::to_string(height) + " pixels");
    facts_.width = static_cast<int>(width);
    facts_.height = static_cast<int>(height);
  }

  static bool has_all(const Imf::ChannelList &list, const std::vector<std::string> &names) {
    for (const std::string &name : names)
      if (!list.findChannel(name)) return false;
    return true;
  }

  void choose_channels(const Imf::Header &header, const SourceOptions &options) {
    const Imf::ChannelList &list = header.channels();
    std::map<double, std::string> spectra;
    for (auto it = list.begin(); it != list.end(); ++it)
      if (const auto nm = spectral_channel_wavelength_nm(it.name())) spectra[*nm] = it.name();
    const bool rgb = has_all(list, {"R", "G", "B"}), xyz = has_all(list, {"X", "Y", "Z"});
    if (!spectra.empty() && (options.spectra || !(rgb || xyz)) && spectra.size() > 1) {
      for (const auto &[nm, name] : spectra) facts_.wavelength_nm.push_back(nm), channels_.push_back(name);
      check_spectral_unit(header);
    } else if (rgb) {
      channels_ = {"R", "G", "B"};
      const std::array<double, 8> own = chromaticities(header), rec709 = ExrPicture{}.chromaticities;
      facts_.rec709 = options.rec709 && std::equal(own.begin(), own.end(), rec709.begin(),
                                                   [](double a, double b) { return std::abs(a - b) < 1e-5; });
      if (!facts_.rec709) to_xyz_ = xyz_of_primaries(own);
    } else if (xyz) {
      channels_ = {"X", "Y", "Z"};
    } else if (list.findChannel("Y")) {
      channels_ = {"Y"};
      if (list.findChannel("RY") || list.findChannel("BY"))
        facts_.notes.push_back("colour as differences to luminance (RY, BY) is not read: taken as grey");
      to_xyz_ = xyz_of_primaries(ExrPicture{}.chromaticities);
    } else {
      throw complaint(path_, "expected channels R,G,B or X,Y,Z or spectra (S0.550,000000nm), found none of them");
    }
    for (const std::string &name : channels_)
      if (const Imf::Channel *channel = list.findChannel(name); channel->xSampling != 1 || channel->ySampling != 1)
        throw complaint(path_, "channel '" + name + "' is subsampled, which is not supported");
    if (!facts_.spectral()) apply_unit(header, options);
  }

  std::array<double, 8> chromaticities(const Imf::Header &header) const {
    if (!Imf::hasChromaticities(header)) return ExrPicture{}.chromaticities;
    const Imf::Chromaticities &c = Imf::chromaticities(header);
    std::array<double, 8> xy{};
    const Imath::V2f points[4] = {c.red, c.green, c.blue, c.white};
    for (std::size_t i = 0; i < 4; ++i)
      xy[2 * i] = static_cast<double>(points[i].x), xy[2 * i + 1] = static_cast<double>(points[i].y);
    const Matrix3 m = xyz_of_primaries(xy);
    for (const auto &row : m)
      for (const double value : row)
        if (!std::isfinite(value))
          throw complaint(path_, "attribute 'chromaticities': expected primaries that span a triangle and a white");
    return xy;
  }

  void apply_unit(const Imf::Header &header, const SourceOptions &options) {
    double unit = 1;
    if (options.unit_cd_m2) unit = *options.unit_cd_m2;
    else if (Imf::hasWhiteLuminance(header)) unit = static_cast<double>(Imf::whiteLuminance(header));
    else facts_.absolute = false;
    if (!(unit > 0) || std::isinf(unit))
      throw complaint(path_, "attribute 'whiteLuminance': expected a luminance above 0 cd/m2");
    for (auto &row : to_xyz_)
      for (double &value : row) value *= unit;
  }

  void check_spectral_unit(const Imf::Header &header) {
    const auto *unit = header.findTypedAttribute<Imf::StringAttribute>("emissiveUnits");
    const std::string text = unit ? unit->value() : "";
    if (text == "W.m^-2.sr^-1" || text == "W.m^-2.sr^-1.nm^-1") return;
    facts_.notes.push_back((unit ? "spectra in '" + text + "'" : std::string("spectra without emissiveUnits")) +
                           " are taken as W m^-2 sr^-1 nm^-1");
  }

  void read_geometry(const Imf::Header &header) {
    for (const char *name : {"greenray.fov_deg", "fov_deg"})
      if (const auto fov = number_attribute(header, name); fov && *fov > 0 && *fov < 180) facts_.fov_deg = fov;
    const auto crop = number_attribute(header, "greenray.pixel_arcsec");
    if (crop && *crop > 0) {  // a crop sees less than its scene
      const double width_deg = *crop * facts_.width / 3600;
      if (!facts_.fov_deg || width_deg < 0.99 * *facts_.fov_deg) facts_.fov_deg = width_deg;
    }
  }

  static void spread_grey(std::vector<float> &planes, std::size_t count) {
    planes.resize(3 * count);
    std::copy_n(planes.begin(), count, planes.begin() + static_cast<std::ptrdiff_t>(count));
    std::copy_n(planes.begin(), count, planes.begin() + static_cast<std::ptrdiff_t>(2 * count));
  }

  fs::path path_;
  std::unique_ptr<ExrChunks> chunks_;              // of scanlines; else
  std::unique_ptr<Imf::MultiPartInputFile> file_;  // of tiles, which the C++ library joins to rows
  std::unique_ptr<Imf::InputPart> part_;
  Imath::Box2i window_;
  std::vector<std::string> channels_;
  Matrix3 to_xyz_{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  std::mutex lock_;
};

}  // namespace

std::unique_ptr<PictureSource> open_exr(const fs::path &path, const SourceOptions &options) {
  try {
    return std::make_unique<ExrSource>(path, options);
  } catch (const Error &) {
    throw;
  } catch (const std::exception &problem) {
    throw complaint(path, std::string("not a readable EXR file (") + problem.what() + ")");
  }
}

}  // namespace greenray
