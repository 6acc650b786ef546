/* What stands before the sky: upright targets at distances from the eye, each a strip of the cylinder about it.

   A ray's height at a distance depends on its apparent elevation and its wavelength alone. So a distance is a station
   of the sight table: [entries][stations][TARGET_CHANNEL_COUNT][waves], wavelength fastest, entries those of the
   transfer table (shared/sky.h). */

enum TargetChannel {
  TARGET_HEIGHT = 0,   /* of the ray above the surface at the station [m]; where it ended before, its straight way on */
  TARGET_PASSED = 1,   /* share of the light from there that reaches the eye */
  TARGET_AIRLIGHT = 2, /* light of the air up to there, in the two parts of SKY_GLOW and SKY_AUREOLE */
  TARGET_AUREOLE = 3,
  TARGET_FROM_SUN = 4, /* altitude of the direction there minus that of the Sun's centre [rad] */
  TARGET_CRESTS = 5,   /* mean number of wave crests before the station that rise into the ray */
  TARGET_JOINED = 6,   /* as SKY_JOINED */
  TARGET_CHANNEL_COUNT = 7
};

/* Across: metres along the arc through the target, to the right of its middle. Up: metres above the surface. */
typedef struct Target {
  float azimuth_rad;    /* of its middle from the picture's centre, clockwise */
  float metres_per_rad; /* of azimuth, along the arc */
  float left_m, right_m, bottom_m, top_m;
  int station;
  int first;         /* outline: its first corner; picture: its first texel */
  int corners;       /* of an outline; 0: a picture */
  int width, height; /* of a picture, in texels; rows from the bottom up */
  int pad_;
} Target;

/* Coefficients of a reflectance spectrum (shared/material.h, SpectrumCurve), and how much it covers. */
typedef struct TargetTexel {
  float c0, c1, c2, alpha;
} TargetTexel;

/* Rows of the table of lights, [1 + targets][waves]: each wavelength's place in 0..1 for the curves, then for each
   target the radiance of its outline, or of a white texel of its picture [W m^-2 sr^-1 nm^-1]. */
enum TargetLightRow { TARGET_LIGHT_PLACE = 0, TARGET_LIGHT_FIRST = 1 };

/* What the kernel is told beside the tables. With waves one station more is that of the sea, the last, whose crests are
   those of the whole ray; where they stand in the way the sea is seen as at `sea_entry`, just below the horizon.

   One draw of the waves hides a ray if the crests in its way are more than a threshold, a smooth random function of
   azimuth (render/sea.hpp), tabulated over the picture. */
typedef struct TargetScale {
  int targets, stations;
  int crests;    /* entries of the table of thresholds; 0: no waves */
  int sea_entry; /* of the transfer table */
  float first_crest_rad, crests_per_rad;
} TargetScale;
