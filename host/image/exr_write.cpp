#include <ImfAttribute.h>
#include <ImfChannelList.h>
#include <ImfChromaticities.h>
#include <ImfDoubleAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>

#include <charconv>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <thread>
#include <utility>

#include "image/colour.hpp"
#include "image/exr.hpp"
#include "image/exr_rows.hpp"
#include "support/error.hpp"

namespace greenray {

namespace {

/// OpenEXR writes through our file. Failures inside OpenEXR's destructors, which swallow them, come back at seal().
class AtomicStream : public Imf::OStream {
 public:
  explicit AtomicStream(AtomicFile &file) : Imf::OStream(file.target().c_str()), file_(file) {}
  void write(const char bytes[], int count) override { file_.write(bytes, static_cast<std::size_t>(count)); }
  std::uint64_t tellp() override { return file_.position(); }
  void seekp(std::uint64_t position) override { file_.seek(position); }

 private:
  AtomicFile &file_;
};

/// One channel as it lies in memory; OpenEXR only reads through the pointer.
struct ChannelView {
  std::string name;
  const float *first;
  std::size_t stride_floats;
};

struct PartView {
  std::string name;
  std::vector<ChannelView> channels;
};

void insert_attributes(Imf::Header &header, const ExrAttributes &attributes) {
  for (const auto &[name, value] : attributes) {
    if (name.empty() || header.find(name.c_str()) != header.end())
      throw std::invalid_argument("EXR attribute '" + name + "' is reserved");
    if (const auto *text = std::get_if<std::string>(&value)) header.insert(name, Imf::StringAttribute(*text));
    else header.insert(name, Imf::DoubleAttribute(std::get<double>(value)));
  }
}

Imf::Header part_header(int width, int height, const PartView &part) {
  Imf::Header header(width, height);
  header.compression() = Imf::ZIP_COMPRESSION;
  header.zipCompressionLevel() = 2;  // four times as fast as the default for 3 % more bytes [measured on a Sun]
  header.setType(Imf::SCANLINEIMAGE);
  header.setName(part.name);
  Imf::addChromaticities(header, Imf::Chromaticities());  // Rec. 709, D65; OpenEXR wants them equal in all parts
  for (const ChannelView &channel : part.channels) header.channels().insert(channel.name, Imf::Channel(Imf::FLOAT));
  return header;
}

void write_parts(AtomicFile &file, int width, int height, const std::vector<PartView> &parts,
                 std::vector<Imf::Header> headers) {
  if (Imf::globalThreadCount() == 0) Imf::setGlobalThreadCount(static_cast<int>(std::thread::hardware_concurrency()));
  AtomicStream stream(file);
  Imf::MultiPartOutputFile output(stream, headers.data(), static_cast<int>(headers.size()));
  for (std::size_t p = 0; p < parts.size(); ++p) {
    Imf::FrameBuffer frame;
    for (const ChannelView &channel : parts[p].channels) {
      const std::size_t x_stride = channel.stride_floats * sizeof(float);
      char *base = const_cast<char *>(reinterpret_cast<const char *>(channel.first));
      frame.insert(channel.name, Imf::Slice(Imf::FLOAT, base, x_stride, x_stride * static_cast<std::size_t>(width)));
    }
    Imf::OutputPart part(output, static_cast<int>(p));
    part.setFrameBuffer(frame);
    part.writePixels(height);
  }
}

/// OpenEXR's own complaints become ours; RunError of the file passes unchanged.
template <class Work>
void as_run_error(const AtomicFile &file, Work &&work) {
  try {
    work();
  } catch (const Error &) {
    throw;
  } catch (const std::invalid_argument &) {
    throw;
  } catch (const std::exception &error) {
    throw RunError("cannot write " + file.target().string() + ": " + error.what());
  }
}

void check_size(int width, int height, std::size_t values, std::size_t per_pixel, const std::string &what) {
  if (width < 1 || height < 1) throw std::invalid_argument("EXR picture has no pixels");
  if (values != static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * per_pixel)
    throw std::invalid_argument("EXR " + what + " does not fit the size of the picture");
}

PartView colour_part(const RgbImage &rgb) {
  return {"picture", {{"R", rgb.rgb.data(), 3}, {"G", rgb.rgb.data() + 1, 3}, {"B", rgb.rgb.data() + 2, 3}}};
}

void add_colour_attributes(Imf::Header &header) { Imf::addWhiteLuminance(header, 1.0F); }

void add_spectral_attributes(Imf::Header &header) {
  header.insert("spectralLayoutVersion", Imf::StringAttribute("1.0"));
  header.insert("emissiveUnits", Imf::StringAttribute("W.m^-2.sr^-1"));
}

std::size_t replace_not_finite(std::vector<float> &values) {
  std::size_t replaced = 0;
  for (float &value : values)
    if (!std::isfinite(value)) value = 0, ++replaced;
  return replaced;
}

bool all_finite(const std::vector<float> &values) {
  for (const float value : values)
    if (!std::isfinite(value)) return false;
  return true;
}

void write_checked(AtomicFile &file, const SpectralImage &image, const ExrAttributes &attributes,
                   const ExrOptions &options) {
  const RgbImage rgb = rgb_from_spectral(image);
  std::vector<PartView> parts{colour_part(rgb)};
  const std::size_t count = image.wavelength_nm.size();
  if (options.spectral)
    for (std::size_t i = 0; i < count; ++i)
      parts[0].channels.push_back({spectral_channel_name(image.wavelength_nm[i]), image.radiance.data() + i, count});
  for (const auto &[name, values] : image.channels) {
    check_size(image.width, image.height, values.size(), 1, "channel " + name);
    parts.push_back({name, {{name, values.data(), 1}}});
  }
  std::vector<Imf::Header> headers;
  for (const PartView &part : parts) headers.push_back(part_header(image.width, image.height, part));
  add_colour_attributes(headers[0]);
  if (options.spectral) add_spectral_attributes(headers[0]);
  insert_attributes(headers[0], attributes);
  write_parts(file, image.width, image.height, parts, std::move(headers));
}

}  // namespace

std::string spectral_channel_name(double wavelength_nm) {
  char text[64];
  const auto [end, error] = std::to_chars(text, text + sizeof text, wavelength_nm, std::chars_format::fixed, 6);
  if (error != std::errc{}) throw std::invalid_argument("wavelength out of range");
  std::string number(text, end);
  number[number.find('.')] = ',';
  return "S0." + number + "nm";
}

ExrReport write_exr(AtomicFile &file, const SpectralImage &image, const ExrAttributes &attributes,
                    const ExrOptions &options) {
  check_size(image.width, image.height, image.radiance.size(), image.wavelength_nm.size(), "spectra");
  ExrReport report;
  as_run_error(file, [&] {
    if (all_finite(image.radiance)) return write_checked(file, image, attributes, options);
    SpectralImage cleaned = image;
    report.not_finite_replaced = replace_not_finite(cleaned.radiance);
    write_checked(file, cleaned, attributes, options);
  });
  return report;
}

ExrReport write_exr(const std::filesystem::path &path, const SpectralImage &image, const ExrAttributes &attributes,
                    const ExrOptions &options) {
  AtomicFile file(path);
  const ExrReport report = write_exr(file, image, attributes, options);
  file.commit();
  return report;
}

void write_exr(AtomicFile &file, const RgbImage &image, const ExrAttributes &attributes) {
  check_size(image.width, image.height, image.rgb.size(), 3, "colours");
  as_run_error(file, [&] {
    const PartView part = colour_part(image);
    std::vector<Imf::Header> headers{part_header(image.width, image.height, part)};
    add_colour_attributes(headers[0]);
    insert_attributes(headers[0], attributes);
    write_parts(file, image.width, image.height, {part}, std::move(headers));
  });
}

void write_exr(const std::filesystem::path &path, const RgbImage &image, const ExrAttributes &attributes) {
  AtomicFile file(path);
  write_exr(file, image, attributes);
  file.commit();
}

struct ExrRowWriter::State {
  AtomicFile &file;
  AtomicStream stream;
  int width;
  std::vector<std::string> channels;
  std::unique_ptr<Imf::OutputFile> output;
};

ExrRowWriter::ExrRowWriter(AtomicFile &file, int width, int height, const std::vector<std::string> &channels,
                           double white_luminance_cd_m2)
    : state_(new State{file, AtomicStream(file), width, channels, nullptr}) {
  as_run_error(file, [&] {
    if (Imf::globalThreadCount() == 0) Imf::setGlobalThreadCount(static_cast<int>(std::thread::hardware_concurrency()));
    Imf::Header header(width, height);
    header.compression() = Imf::ZIP_COMPRESSION;
    header.zipCompressionLevel() = 2;
    Imf::addChromaticities(header, Imf::Chromaticities());
    if (white_luminance_cd_m2 > 0) Imf::addWhiteLuminance(header, static_cast<float>(white_luminance_cd_m2));
    for (const std::string &name : channels) header.channels().insert(name, Imf::Channel(Imf::FLOAT));
    state_->output = std::make_unique<Imf::OutputFile>(state_->stream, header);
  });
}

ExrRowWriter::~ExrRowWriter() = default;

void ExrRowWriter::append(const std::vector<float> &values, int first_row, int rows) {
  as_run_error(state_->file, [&] {
    const std::size_t pixel_bytes = sizeof(float) * state_->channels.size();
    const std::size_t row_bytes = pixel_bytes * static_cast<std::size_t>(state_->width);
    // OpenEXR counts from row 0 of the picture, which may lie before our piece
    char *base = const_cast<char *>(reinterpret_cast<const char *>(values.data())) -
                 static_cast<std::ptrdiff_t>(row_bytes) * first_row;
    Imf::FrameBuffer frame;
    for (const std::string &name : state_->channels) {
      frame.insert(name, Imf::Slice(Imf::FLOAT, base, pixel_bytes, row_bytes));
      base += sizeof(float);
    }
    state_->output->setFrameBuffer(frame);
    state_->output->writePixels(rows);
  });
}

void ExrRowWriter::finish() {
  as_run_error(state_->file, [&] { state_->output.reset(); });
}

}  // namespace greenray
