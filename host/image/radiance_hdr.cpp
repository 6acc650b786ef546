// Radiance pictures: four bytes a pixel, three mantissas and a common exponent.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <mutex>
#include <sstream>

#include "image/picture_source.hpp"
#include "support/error.hpp"

namespace greenray {
namespace fs = std::filesystem;

namespace {

constexpr double efficacy_lm_W = 179;  // of Radiance's white
constexpr std::array<double, 8> radiance_primaries{0.640, 0.330, 0.290, 0.600, 0.150, 0.060, 1.0 / 3, 1.0 / 3};
constexpr double d65_x = 0.3127, d65_y = 0.3290;

/// file:line:1 in the header, file:1:1 in the pixels.
InputError complaint(const fs::path &path, int line, const std::string &message) {
  return InputError(SourcePlace{path.string(), line, 1}, message);
}

struct Header {
  bool is_xyz = false;
  double exposure = 1;
  std::array<double, 3> colour_correction{1, 1, 1};
  std::array<double, 8> primaries = radiance_primaries;
  std::optional<double> fov_deg;
  bool bottom_up = false, right_to_left = false;
  int width = 0, height = 0;
  std::size_t pixels_at = 0;
};

std::vector<double> numbers(const std::string &text) {
  std::istringstream in(text);
  return {std::istream_iterator<double>(in), {}};
}

class HeaderReader {
 public:
  HeaderReader(const fs::path &path, const std::string &bytes) : path_(path), bytes_(bytes) {}

  Header read() {
    next_line();  // "#?RADIANCE"
    for (std::string line = next_line(); !line.empty(); line = next_line()) variable(line);
    size(next_line());
    header_.pixels_at = at_;
    return header_;
  }

 private:
  std::string next_line() {
    const std::size_t end = bytes_.find('\n', at_);
    if (end == std::string::npos || end - at_ > 65536)
      throw complaint(path_, line_, "damaged Radiance picture: its header does not end");
    const std::string line = bytes_.substr(at_, end - at_);
    at_ = end + 1;
    ++line_;
    return !line.empty() && line.back() == '\r' ? line.substr(0, line.size() - 1) : line;
  }

  void variable(const std::string &line) {
    const auto after = [&line](const char *name) -> std::optional<std::string> {
      const std::string start = name;
      return line.rfind(start, 0) == 0 ? std::optional(line.substr(start.size())) : std::nullopt;
    };
    if (const auto format = after("FORMAT=")) {
      std::istringstream words(*format);  // with spaces around it, as Radiance itself takes it
      std::string name, more;
      words >> name;
      if ((name != "32-bit_rle_rgbe" && name != "32-bit_rle_xyze") || words >> more)
        throw complaint(path_, line_ - 1, "FORMAT: expected 32-bit_rle_rgbe or 32-bit_rle_xyze, found " + *format);
      header_.is_xyz = name == "32-bit_rle_xyze";
    } else if (const auto exposure = after("EXPOSURE=")) {
      header_.exposure *= factors(*exposure, 1, "EXPOSURE")[0];
    } else if (const auto correction = after("COLORCORR=")) {
      const std::vector<double> f = factors(*correction, 3, "COLORCORR");
      for (std::size_t c = 0; c < 3; ++c) header_.colour_correction[c] *= f[c];
    } else if (const auto primaries = after("PRIMARIES=")) {
      const std::vector<double> xy = numbers(*primaries);
      if (xy.size() != 8) throw complaint(path_, line_ - 1, "PRIMARIES: expected x y of red, green, blue and white");
      std::copy(xy.begin(), xy.end(), header_.primaries.begin());
    } else if (const auto view = after("VIEW=")) {
      read_view(*view);
    }
  }

  std::vector<double> factors(const std::string &text, std::size_t count, const std::string &name) const {
    const std::vector<double> values = numbers(text);
    bool right = values.size() == count;
    for (const double value : values) right = right && value > 0 && std::isfinite(value);
    if (!right) throw complaint(path_, line_ - 1, name + ": expected " + std::to_string(count) + " factors above 0");
    return values;
  }

  void read_view(const std::string &text) {
    std::istringstream words(text);
    std::string word, kind;
    for (std::string value; words >> word;) {
      if (word.rfind("-vt", 0) == 0) kind = word.substr(3);
      if (word == "-vh" && words >> value) {
        const double angle = std::strtod(value.c_str(), nullptr);
        if (angle > 0 && angle < 180 && (kind.empty() || kind == "v")) header_.fov_deg = angle;
      }
    }
  }

  void size(const std::string &line) {
    char first = 0, second = 0, y_sign = 0, x_sign = 0;
    long rows = 0, columns = 0;
    std::istringstream in(line);
    in >> y_sign >> first >> rows >> x_sign >> second >> columns;
    const bool signs = (y_sign == '-' || y_sign == '+') && (x_sign == '-' || x_sign == '+');
    if (in && signs && first == 'X' && second == 'Y')
      throw complaint(path_, line_ - 1, "pictures stored column by column are not supported: turn it with `protate`");
    if (!in || !signs || first != 'Y' || second != 'X' || rows < 1 || columns < 1 || rows > (1 << 17) ||
        columns > (1 << 17))
      throw complaint(path_, line_ - 1, "expected the size of the picture, such as -Y 480 +X 640");
    header_.bottom_up = y_sign == '+';
    header_.right_to_left = x_sign == '-';
    header_.height = static_cast<int>(rows);
    header_.width = static_cast<int>(columns);
  }

  const fs::path &path_;
  const std::string &bytes_;
  std::size_t at_ = 0;
  int line_ = 1;
  Header header_;
};

class RadianceSource : public PictureSource {
 public:
  RadianceSource(const fs::path &path, const SourceOptions &options) : path_(path) {
    std::ifstream in(path, std::ios::binary);
    bytes_.assign(std::istreambuf_iterator<char>(in), {});
    header_ = HeaderReader(path, bytes_).read();
    facts_.name = path.string();
    facts_.width = header_.width;
    facts_.height = header_.height;
    facts_.fov_deg = header_.fov_deg;
    find_rows();
    make_matrix(options);
  }

  void read(int first, int rows, std::vector<float> &planes) override {
    const auto width = static_cast<std::size_t>(facts_.width);
    const std::size_t count = static_cast<std::size_t>(rows) * width;
    planes.resize(3 * count);
    std::vector<unsigned char> row(4 * width);
    for (int y = 0; y < rows; ++y) {
      const int wanted = header_.bottom_up ? facts_.height - 1 - (first + y) : first + y;
      decode(starts_[static_cast<std::size_t>(wanted)], row.data());
      float *to = planes.data() + static_cast<std::size_t>(y) * width;
      for (std::size_t x = 0; x < width; ++x) {
        const unsigned char *rgbe = row.data() + 4 * (header_.right_to_left ? width - 1 - x : x);
        const float scale = rgbe[3] == 0 ? 0.0F : std::ldexp(1.0F, rgbe[3] - 136);
        for (std::size_t c = 0; c < 3; ++c) to[c * count + x] = scale * (static_cast<float>(rgbe[c]) + 0.5F);
      }
    }
    transform_planes(to_xyz_, planes);
  }

 private:
  const unsigned char *byte(std::size_t at) const {
    return reinterpret_cast<const unsigned char *>(bytes_.data()) + at;
  }

  /// Where each row begins, and that all of them are there.
  void find_rows() {
    std::size_t at = header_.pixels_at;
    for (int y = 0; y < facts_.height; ++y) {
      starts_.push_back(at);
      at = decode(at, nullptr);
    }
  }

  [[noreturn]] void damaged() const { throw complaint(path_, 1, "damaged Radiance picture: some pixels are missing"); }

  /// One row into `to` [4 x width] (or nowhere); returns where the next one begins.
  std::size_t decode(std::size_t at, unsigned char *to) const {
    const auto width = static_cast<std::size_t>(facts_.width);
    if (at + 4 > bytes_.size()) damaged();
    const unsigned char *start = byte(at);
    const bool coded = width >= 8 && width < 32768 && start[0] == 2 && start[1] == 2 && start[2] < 128;
    if (!coded) return decode_flat(at, to);
    if ((static_cast<std::size_t>(start[2]) << 8U | start[3]) != width) damaged();
    at += 4;
    for (std::size_t component = 0; component < 4; ++component)
      for (std::size_t x = 0; x < width;) {
        if (at + 2 > bytes_.size()) damaged();
        const unsigned char code = *byte(at++);
        const std::size_t run = code > 128 ? code - 128U : code;
        if (run == 0 || x + run > width || (code <= 128 && at + run > bytes_.size())) damaged();
        for (std::size_t i = 0; i < run; ++i, ++x)
          if (to) to[4 * x + component] = *byte(code > 128 ? at : at + i);
        at += code > 128 ? 1 : run;
      }
    return at;
  }

  /// Plain pixels, with the old run-length code: (1, 1, 1, n) repeats the last pixel n times, shifted for each in a
  /// row.
  std::size_t decode_flat(std::size_t at, unsigned char *to) const {
    const auto width = static_cast<std::size_t>(facts_.width);
    unsigned shift = 0;
    for (std::size_t x = 0; x < width; at += 4) {
      if (at + 4 > bytes_.size()) damaged();
      const unsigned char *pixel = byte(at);
      if (pixel[0] == 1 && pixel[1] == 1 && pixel[2] == 1) {
        const std::size_t run = static_cast<std::size_t>(pixel[3]) << shift;
        if (x == 0 || shift > 24 || x + run > width) damaged();
        for (std::size_t i = 0; i < run; ++i, ++x)
          if (to) std::copy_n(to + 4 * (x - 1), 4, to + 4 * x);
        shift += 8;
      } else {
        if (to) std::copy_n(pixel, 4, to + 4 * x);
        ++x;
        shift = 0;
      }
    }
    return at;
  }

  /// RGB: its white becomes D65, as on a screen that shows Radiance's white as its own; luminance stays as it is.
  void make_matrix(const SourceOptions &options) {
    if (header_.is_xyz) {
      for (std::size_t c = 0; c < 3; ++c) to_xyz_[c][c] = options.unit_cd_m2.value_or(1);
    } else {
      to_xyz_ = xyz_of_primaries(header_.primaries);
      for (auto &row : to_xyz_)
        for (double &value : row) value *= options.unit_cd_m2.value_or(efficacy_lm_W);
      white_balance();
    }
    for (auto &row : to_xyz_)
      for (std::size_t c = 0; c < 3; ++c) row[c] /= header_.exposure * header_.colour_correction[c];
    for (const auto &row : to_xyz_)
      for (const double value : row)
        if (!std::isfinite(value)) throw complaint(path_, 1, "PRIMARIES: expected primaries that span a triangle");
  }

  /// X and Z of (1,1,1) to those of D65, Y untouched.
  void white_balance() {
    double white[3] = {0, 0, 0};
    for (std::size_t r = 0; r < 3; ++r)
      for (std::size_t c = 0; c < 3; ++c) white[r] += to_xyz_[r][c];
    const double wanted[3] = {white[1] * d65_x / d65_y, white[1], white[1] * (1 - d65_x - d65_y) / d65_y};
    for (std::size_t r = 0; r < 3; ++r)
      for (double &value : to_xyz_[r]) value *= wanted[r] / white[r];
  }

  fs::path path_;
  std::string bytes_;
  Header header_;
  std::vector<std::size_t> starts_;
  Matrix3 to_xyz_{};
};

}  // namespace

std::unique_ptr<PictureSource> open_radiance(const fs::path &path, const SourceOptions &options) {
  return std::make_unique<RadianceSource>(path, options);
}

}  // namespace greenray
