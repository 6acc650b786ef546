/* How much of the disc of a gather lies on surfaces that could hold its photons. */

typedef struct CoverSettings {
  scalar height; /* over the radius: surfaces so far above and below the disc count as in it */
  scalar facing; /* least cosine between their normal and the asking one */
  int count;     /* places */
  int pad_;
} CoverSettings;

/* Shares of the integral of Epanechnikov's kernel over the whole disc, and over the disc of half the area. Where
   something stands in the disc behind which the surface goes on, photons on that other side would count: `clear` is the
   distance to it over the radius, 1 where there is none, `hidden` a place behind it. */
typedef struct Cover {
  float whole, inner, clear;
  float hidden[3];
} Cover;
