// The air and the rays of one case of suite trace, and the refraction they must have.
#pragma once
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "atmosphere/index_table.hpp"
#include "bench/peer.hpp"

namespace greenray::bench {

struct CaseAir {
  std::string name;
  ProfileSpec air;
  double eye_m = 2;
  double margin_deg = 0;  // above the lowest ray that leaves: keeps off the edge, where refraction grows without bound
  double highest_deg = 5;
  std::vector<std::string> without = {};       // words of variants that sit this case out
  std::optional<double> lowest_deg = {};       // in place of the lowest ray that leaves
  std::function<LayeredMedium()> medium = {};  // in place of `air`
  std::vector<double> wavelengths_nm = {550};
};

inline const char *const pal_case = "pal-air";

/// us76, one inversion, ten inversions, and the air of palRefro.
std::vector<CaseAir> trace_cases();

/// Largest errors over the reference rays.
struct Accuracy {
  double error_arcsec = 0;         // |refraction - reference|
  double scaled_error_arcsec = 0;  // the same divided by max(1, |dR/da|): what the eye would see as a shift
  int wrong_outcomes = 0;          // rays that did not end where the reference did
};

class TraceCase {
 public:
  /// timed_rays: evenly spaced altitudes. About one in timed_rays/reference_rays is a reference ray; the stride is odd,
  /// so that each lane has its turn.
  TraceCase(CaseAir air, std::size_t timed_rays, std::size_t reference_rays, unsigned threads);
  TraceCase(const TraceCase &) = delete;  // the medium points into it

  const CaseAir &air() const { return air_; }
  double lowest_deg() const { return lowest_deg_; }
  const IndexTable &table(double error_arcsec);
  /// count of the timed altitudes, evenly taken; a ray for each of them and each wavelength, wavelength fastest.
  /// count 0: the reference rays.
  std::vector<f64::RayStart> starts(const IndexTable &table, std::size_t count) const;
  std::size_t wavelengths() const { return air_.wavelengths_nm.size(); }
  Accuracy accuracy(const Runner &after_reference_rays) const;
  /// Largest difference of the reference from itself with a coarser table and larger steps: what is known of its own
  /// error.
  double reference_error_arcsec() const { return reference_error_arcsec_; }
  std::size_t timed_rays() const { return altitudes_rad_.size(); }

 private:
  void weigh_errors();
  std::vector<Bent> trace_finely(double table_arcsec, double tolerance_rad);

  CaseAir air_;
  std::optional<Profile> profile_;
  LayeredMedium medium_;
  unsigned threads_;
  std::map<double, std::unique_ptr<IndexTable>> tables_;
  std::vector<double> altitudes_rad_, reference_altitudes_rad_;
  std::vector<Bent> reference_;        // [altitudes][wavelengths]
  std::vector<double> amplification_;  // max(1, |dR/da|) of each reference ray
  double lowest_deg_ = 0, reference_error_arcsec_ = 0;
};

/// The table as the twin reads it.
std::vector<f64::IndexCell> twin_cells(const IndexTable &table);

}  // namespace greenray::bench
