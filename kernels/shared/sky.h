/* What the sky kernel is told. The transfer table has one entry per apparent elevation, evenly spaced, and in each
   entry SKY_LIGHT + 2 azimuths rows of SKY_WAVES numbers (wavelength fastest; padded to whole groups of LANES). */

enum SkyChannel {
  SKY_FROM_SUN = 0, /* true altitude minus that of the Sun's centre [rad] */
  SKY_PASSED = 1,   /* share of the light from outside the air that arrives this way; 0 off the sky */
  SKY_JOINED = 2,   /* 1: interpolate to the next entry; less: the fraction of the way at which the outcome changes */
  SKY_GLITTER = 3,  /* of sea that mirrors the Sun: radiance over reflectance x density of slopes / cos^4 of the tilt */
  SKY_GRAZING = 4,  /* sines of the angle at which the line of sight meets the sea, */
  SKY_GLITTER_SUN = 5, /* and of the Sun's altitude there, as seen */
  SKY_LIGHT = 6,       /* from here on two rows for each azimuth: */
  SKY_GLOW = 0,        /* radiance of sky or sea but for the next row */
  SKY_AUREOLE = 1      /* what haze has scattered once, over its phase function of the angle from the Sun */
};

/* Azimuths from the Sun are told by sin^2(azimuth/2); the table has them at Chebyshev's extreme points between the
   picture's nearest and farthest, and the polynomial through all of them is looked up. */
#define SKY_MOST_AZIMUTHS 17

/* Rows of the table of disks, [DISK_MOON_SHADOW + shadow rows][SKY_WAVES]: the Sun's limb darkening times the radiance
   of its centre [W m^-2 sr^-1 nm^-1] outside the air, 0 where there is none; the Moon's radiance where its light is
   2 mu0/(mu0 + mu) = 1; what the Earth's shadow leaves of it, from its axis outward. */
#define LIMB_TERMS 6
enum DiskRow { DISK_MOON = LIMB_TERMS, DISK_MOON_SHADOW = LIMB_TERMS + 1 };

/* The Moon's disk. Directions and lengths on it: right, up, towards the eye, in radii. */
typedef struct MoonView {
  float radius_rad; /* 0: no Moon */
  float azimuth_rad, cos_altitude;
  float above_sun; /* true altitude of its centre minus that of the Sun [rad] */
  float sun_right, sun_up, sun_towards;
  float shadow_right, shadow_up, shadow_rows_per_radius; /* axis of the Earth's shadow */
  int shadow_rows;                                       /* 0: no eclipse */
} MoonView;

typedef struct SkyView {
  float sin_altitude, cos_altitude; /* of the picture's centre */
  float pixel_tangent;              /* tan of one pixel's angle at the centre */
  float centre_column, centre_row;  /* of the optical axis, in pixels of the whole picture */
  float first_elevation_rad, entries_per_rad;
  float sun_azimuth_rad;                    /* from the picture's centre, clockwise */
  float sun_sin_altitude, sun_cos_altitude; /* true altitude of its centre */
  float sun_radius_rad;
  float slope2;                            /* mean square slope of the sea's waves; 0: no glitter */
  float phase_asymmetry;                   /* Henyey & Greenstein's g of the aerosol */
  float azimuth_middle, azimuth_per_half;  /* of sin^2(azimuth/2): x = (it - middle) per_half is -1..1 */
  float azimuth_places[SKY_MOST_AZIMUTHS]; /* x of each */
  int azimuths;                            /* 0: no light but the Sun's */
  MoonView moon;
  int entries;
  int width, rows;             /* of this band */
  int first_column, first_row; /* of this band in the whole picture: a crop has the same samples as the whole */
  unsigned int seed;
  int first_sample, samples; /* of this launch */
} SkyView;
