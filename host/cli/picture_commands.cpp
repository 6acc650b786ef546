// greenray compare: how far two pictures are apart.
#include <iostream>
#include <nlohmann/json.hpp>

#include "cli/commands.hpp"
#include "image/compare.hpp"

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

}  // namespace

Command compare_command() {
  return {with_common({"compare",
                       "A.exr B.exr",
                       "Differences of two pictures; exit 6 when they are larger than allowed.",
                       {{"--max-rms", "", "X", "largest RMS difference allowed [cd/m2]"}}}),
          compare};
}

}  // namespace greenray::cli
