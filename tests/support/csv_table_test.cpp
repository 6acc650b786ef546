// Tables of numbers: what is read, what is refused and where.
#include "support/csv_table.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support/error.hpp"

namespace greenray {

static std::string input_error(const std::string &text) {
  try {
    CsvTable::parse(text, "t.csv");
  } catch (const InputError &error) {
    return error.what();
  }
  return "";
}

// oracle: the text itself; straight lines between rows.  tolerance: exact, or rounding of one operation
TEST(CsvTable, ReadsAndInterpolates) {
  const CsvTable table =
      CsvTable::parse("\xEF\xBB\xBF# source: here\r\n\r\nnm, value\r\n 400 ,1e-3\r\n410,3e-3\n# end\n420,-2", "t");
  EXPECT_EQ(table.rows(), 3U);
  EXPECT_EQ(table.names(), (std::vector<std::string>{"nm", "value"}));
  EXPECT_EQ(table.column("value"), (std::vector<double>{1e-3, 3e-3, -2}));
  EXPECT_TRUE(table.has("nm"));
  EXPECT_FALSE(table.has("um"));
  EXPECT_EQ(table.interpolate("nm", "value", 410), 3e-3);
  EXPECT_NEAR(table.interpolate("nm", "value", 402.5), 1.5e-3, 1e-18);
  EXPECT_EQ(table.interpolate("nm", "value", 399.9), 0);
  EXPECT_EQ(table.interpolate("nm", "value", 420.1), 0);
  EXPECT_EQ(table.interpolate("nm", "value", 420), -2);
  EXPECT_EQ(table.interpolate("nm", "value", 300, CsvTable::Outside::clamp), 1e-3);
  EXPECT_EQ(table.interpolate("nm", "value", 900, CsvTable::Outside::clamp), -2);
  EXPECT_TRUE(std::isnan(table.interpolate("nm", "value", std::nan(""))));
}

// oracle: line and column counted by hand.  tolerance: none
TEST(CsvTable, ComplaintsSayWhere) {
  EXPECT_EQ(input_error("a,b\n1,x2\n1\n nan,1"),
            "t.csv:2:3: expected a number, found 'x2'\nt.csv:3:1: expected 2 columns, found 1\n"
            "t.csv:4:2: expected a number, found 'nan'");
  EXPECT_EQ(input_error("a,a\n"), "t.csv:1:3: column 'a' appears twice");
  EXPECT_EQ(input_error("1,2\n").substr(0, 12), "t.csv:1:1: e");
  EXPECT_EQ(input_error("# nothing\n"), "t.csv:1:1: expected a header row of column names");
  EXPECT_EQ(input_error("a,b\n1,\n"), "t.csv:2:3: expected a number, found ''");
  const CsvTable table = CsvTable::parse("height_m\n2\n1\n", "t.csv");
  EXPECT_THROW(table.interpolate("height_m", "height_m", 1), InputError);
  try {
    (void)table.column("heigth_m");
    FAIL();
  } catch (const InputError &error) {
    EXPECT_STREQ(error.what(), "t.csv:1:1: no column 'heigth_m' (did you mean 'height_m'?)");
  }
}

// oracle: published values: ybar(555 nm) = 1 (CIE 15); Rayleigh cross-section falls as about the fourth power; the
//         limb-darkening polynomials are 1 at the disk's centre.  tolerance: digits printed in the tables
TEST(CsvTable, BuiltInTables) {
  EXPECT_EQ(CsvTable::embedded("host/data/cie1931_2deg_xyz_5nm.csv").interpolate("nm", "y", 555), 1.0);
  const CsvTable air = CsvTable::embedded("host/data/rayleigh_5nm.csv");
  const double ratio = air.interpolate("nm", "tau_sealevel_45N", 400) / air.interpolate("nm", "tau_sealevel_45N", 700);
  EXPECT_NEAR(std::log(ratio) / std::log(700.0 / 400.0), 4.08, 0.06);  // 4 plus the dispersion of air
  const CsvTable limb = CsvTable::embedded("host/data/limb_darkening_neckel_labs1994.csv");
  for (std::size_t row = 0; row < limb.rows(); ++row) {
    double sum = 0;
    for (const char *a : {"A0", "A1", "A2", "A3", "A4", "A5"}) sum += limb.column(a)[row];
    EXPECT_NEAR(sum, 1.0, 5e-5);
  }
  EXPECT_GT(CsvTable::embedded("host/data/solar_extraterrestrial_5nm.csv").interpolate("nm", "E490", 550), 1.8);
  EXPECT_GT(CsvTable::embedded("host/data/ozone_chappuis_xsec_10nm.csv").interpolate("nm_centre", "sigma_m2", 605),
            4e-25);
  EXPECT_THROW(CsvTable::embedded("host/data/no_such_table.csv"), RunError);
}

}  // namespace greenray
