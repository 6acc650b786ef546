// greenray compare and develop: pictures that exist already.
#include <iostream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/commands.hpp"
#include "image/compare.hpp"
#include "image/develop.hpp"
#include "image/exr.hpp"
#include "support/atomic_file.hpp"

namespace greenray::cli {
namespace {

int compare(const Arguments &a) {
  const std::optional<double> max_rms = a.optional_number("--max-rms", 0, 1e30, "cd/m2");
  const ImageDifference c = compare_exr(a.positional()[0], a.positional()[1]);
  if (a.has("--json")) {
    const auto finite = [](double x) { return std::isfinite(x) ? nlohmann::json(x) : nlohmann::json(); };
    std::cout << nlohmann::json{{"rms", finite(c.rms)},
                                {"max_abs", finite(c.max_abs)},
                                {"relative_rms", finite(c.relative_rms)},
                                {"psnr_db", finite(c.psnr_db)},
                                {"pixels", c.pixels}}
                     .dump(1)
              << "\n";
  } else {
    std::cout << "rms " << c.rms << "  max " << c.max_abs << "  relative rms " << c.relative_rms << "  psnr "
              << c.psnr_db << " dB  over " << c.pixels << " pixels\n";
  }
  return max_rms && !(c.rms <= *max_rms) ? static_cast<int>(ExitCode::different) : 0;
}

int develop(const Arguments &a) {
  const std::string observer = a.choice("--observer", {"human", "camera", "linear"}, "camera");
  if (observer != "camera") a.fail("--observer", "only the camera is built in this version: expected camera");
  const auto ev = a.optional_number("--exposure", -60, 60, "EV");
  const std::string png = a.file("--output", ".png");
  const ExrPicture picture = read_exr(a.positional()[0]);
  const CameraPicture camera = develop_camera(picture.rgb(), {ev, 8, true});
  AtomicFile file(png);
  write_png(file, camera.pixels);
  file.commit();
  if (!a.has("--quiet"))
    std::cout << "wrote    " << png << "  (key " << camera.report.key_cd_m2 << " cd/m2, " << camera.report.gamut_moved
              << " pixels brought into gamut)\n";
  return 0;
}

}  // namespace

Command compare_command() {
  return {with_common({"compare",
                       "A.exr B.exr",
                       "Differences of two pictures; exit 6 when they are larger than allowed.",
                       {{"--max-rms", "", "X", "largest RMS difference allowed [cd/m2]"}}}),
          compare};
}

Command develop_command() {
  return {with_common({"develop",
                       "IN.exr",
                       "A picture as a camera would show it, from any EXR.",
                       {{"--output", "-o", "OUT.png", "where to write", true},
                        {"--observer", "", "O", "camera (default)"},
                        {"--exposure", "", "EV", "stops on top of the automatic exposure"}}}),
          develop};
}

}  // namespace greenray::cli
