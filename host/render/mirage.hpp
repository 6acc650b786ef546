// The mirages of an eye: the branches and folds of its transfer curve, how often each part of the sky is seen, and the
// strips of the view from which no light of the sky comes.
#pragma once
#include <string>
#include <vector>

#include "render/transfer_curve.hpp"

namespace greenray {

/// What bounds a branch of the curve.
enum class BranchEnd {
  fold,       // the true altitude has an extreme: two images meet there
  horizon,    // beyond it rays meet the ground
  duct_edge,  // beyond it rays are held in a duct, or go another way around its top
  jump,       // the true altitude leaps
  zenith,     // 90 degrees
  limit       // of the altitudes looked at
};
const char *branch_end_name(BranchEnd end);  // "duct-edge"

/// An extreme of the true altitude along the view: from here the image turns over.
struct Fold {
  int number = 0;  // ascending in apparent altitude
  double apparent_altitude_deg = 0, true_altitude_deg = 0;
  bool highest = false;  // the true altitude has a maximum (the images below it vanish upwards), else a minimum
};

/// A stretch of the view that shows a stretch of the sky once: one image.
struct Branch {
  int number = 0;                                    // ascending in apparent altitude
  double low_deg = 0, high_deg = 0;                  // apparent
  double true_at_low_deg = 0, true_at_high_deg = 0;  // -infinity: beside a duct's edge rays go round the Earth at will
  bool erect = true;                                 // else upside down
  BranchEnd low_end = BranchEnd::limit, high_end = BranchEnd::limit;
  double lowest_true_deg() const { return erect ? true_at_low_deg : true_at_high_deg; }
  double highest_true_deg() const { return erect ? true_at_high_deg : true_at_low_deg; }
};

/// Where rays of sight end: space, ground or trapped, or the step limit.
struct FateBand {
  double low_deg = 0, high_deg = 0;  // apparent
  int outcome = 0;
};

/// A stretch of true altitudes, all of which are seen equally often.
struct ImageCount {
  double low_true_deg = 0, high_true_deg = 0;  // low: -infinity where a duct shows the sky however low
  int images = 0;
};

struct Mirages {
  double wavelength_nm = 0;
  std::vector<FateBand> fates;  // each list ascending
  std::vector<Fold> folds;
  std::vector<Branch> branches;
  std::vector<ImageCount> counts;
  int most_images = 0;
  double least_fold_arcsec = 0;  // folds whose images would be less apart than this in true altitude are left out
  /// The curve itself, thinned to what a plot shows; NaN between pieces.
  std::vector<double> apparent_deg, true_deg;

  const Branch *branch_at(double apparent_deg_) const;
  /// Number of images of a true altitude.
  int images_of(double true_altitude_deg) const;
};

struct MirageOptions {
  double tolerance_arcsec = 0.01;   // of the curve between its entries
  double least_fold_arcsec = 0.05;  // in true altitude
  double narrowest_rad = 2e-9;      // of the curve's intervals
};

/* Every wavelength of `rays`, from just below the lowest altitude at which light of the sky may arrive up to the
   zenith. air: over the eye, the medium of `rays`; of air that varies along the surface the curve is followed to
        narrowest_rad, and no duct's edges are known beforehand
   method: the curve of transfer_curve.hpp, whose breaks are exact; each extreme of it is then closed in on by tracing
        nine rays across it, again and again, until they agree to rounding. Close to the edge of a duct whose top is
        smooth the true altitude falls without end, as the logarithm of the distance; at a kink it stays finite.
   source: Wegener's transfer curve; ends of branches from Bouguer's invariant N cos e */
std::vector<Mirages> find_mirages(SkyRays &rays, const Profile &air, const MirageOptions &options = {});

}  // namespace greenray
